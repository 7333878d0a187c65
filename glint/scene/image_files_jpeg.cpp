// SPDX-License-Identifier: MIT
// JPEG by libjpeg-turbo.
#include <turbojpeg.h>

#include <algorithm>
#include <memory>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

struct Destroy {
  void operator()(void* decoder) const { tjDestroy(decoder); }
};

// A warning is damage, too: missing data become grey, and where bytes are left over between parts
// of the picture, the decoder may have lost its place long before.
void check(const fs::path& path, tjhandle decoder, int result) {
  if (result != 0) detail::fail_incomplete(path, "JPEG", tjGetErrorStr2(decoder));
}

}  // namespace

Image detail::decode_jpeg(const fs::path& path, const std::string& file) {
  const std::unique_ptr<void, Destroy> decoder(tjInitDecompress());
  GLINT_CHECK(decoder != nullptr, kEnvironment, "{}: no memory for a decoder", path.string());
  const auto* bytes = reinterpret_cast<const unsigned char*>(file.data());
  int width = 0, height = 0, subsampling = 0, colors = 0;
  check(
      path,
      decoder.get(),
      tjDecompressHeader3(decoder.get(), bytes, file.size(), &width, &height, &subsampling, &colors)
  );
  GLINT_CHECK(
      colors != TJCS_CMYK && colors != TJCS_YCCK,
      kBadReference,
      "{}: inks (CMYK) instead of colours; save it as RGB",
      path.string()
  );
  const bool grey = colors == TJCS_GRAY;
  MaskImage pixels(width, height, grey ? 1 : 3);
  check(
      path,
      decoder.get(),
      tjDecompress2(
          decoder.get(),
          bytes,
          file.size(),
          pixels.data(),
          width,
          0,
          height,
          grey ? TJPF_GRAY : TJPF_RGB,
          TJFLAG_STOPONWARNING
      )
  );
  Image picture(width, height, pixels.channels());
  std::transform(
      pixels.values().begin(),
      pixels.values().end(),
      picture.data(),
      [&](unsigned char value) { return unit_value(value, 255); }
  );
  return picture;
}

std::string jpeg_bytes(ByteView image, int quality) {
  const std::unique_ptr<void, Destroy> encoder(tjInitCompress());
  const bool grey = image.channels == 1;
  const int subsampling = grey ? TJSAMP_GRAY : TJSAMP_420;
  std::string bytes(tjBufSize(image.width, image.height, subsampling), '\0');
  auto* begin = reinterpret_cast<unsigned char*>(bytes.data());
  unsigned long size = bytes.size();
  const bool made = encoder != nullptr && tjCompress2(
                                              encoder.get(),
                                              image.data,
                                              image.width,
                                              0,
                                              image.height,
                                              grey ? TJPF_GRAY : TJPF_RGB,
                                              &begin,
                                              &size,
                                              subsampling,
                                              quality,
                                              TJFLAG_NOREALLOC | TJFLAG_FASTDCT
                                          ) == 0;
  GLINT_CHECK(made, kEnvironment, "no JPEG of {} x {} pixels", image.width, image.height);
  bytes.resize(size);
  return bytes;
}

}  // namespace glint
