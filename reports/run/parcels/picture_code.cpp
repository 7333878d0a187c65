// SPDX-License-Identifier: MIT
#include "reports/run/parcels/picture_code.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/files.h"
#include "glint/scene/image_files.h"
#include "glint/scene/sample_codec.h"

namespace glint {
namespace {

constexpr int kMostSide = 8192;
constexpr std::size_t kMostSamples = std::size_t{1} << 23;  // of larger pictures the PNG goes along

SampleFormat format_of(int channels) { return {.channels = channels, .bits = 8}; }

std::size_t num_samples(const PictureCode& code) {
  return static_cast<std::size_t>(code.width) * static_cast<std::size_t>(code.height) *
         static_cast<std::size_t>(code.channels);
}

// The pixels of a PNG file; nothing: they are no bytes.
std::optional<ByteImage> pixels_of(const std::string& png) {
  const TemporaryFolder folder("glint-parcel");
  write_file(folder / "picture.png", png);
  try {
    const Image image = read_image(folder / "picture.png");
    ByteImage bytes = to_bytes(image);
    for (std::size_t i = 0; i < bytes.values().size(); ++i)
      if (std::abs(static_cast<float>(bytes.values()[i]) - 255.0f * image.values()[i]) > 1e-3f)
        return std::nullopt;
    return bytes;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<PictureCode> code_picture(const std::string& png) {
  const auto pixels = pixels_of(png);
  if (!pixels || pixels->values().size() > kMostSamples) return std::nullopt;
  PictureCode code{pixels->width(), pixels->height(), pixels->channels()};
  const auto values = pixels->values();
  code.pixels.assign(values.begin(), values.end());
  SampleEncoder encoder(format_of(code.channels));
  encoder.add(pixels->size(), std::vector<std::uint32_t>(values.begin(), values.end()));
  code.coded = encoder.finish();
  if (code.coded.size() >= png.size()) return std::nullopt;
  return code;
}

std::string picture_of_code(PictureCode& code, const std::string& where) {
  const auto is_side = [](int pixels) { return pixels > 0 && pixels <= kMostSide; };
  GLINT_CHECK(
      is_side(code.width) && is_side(code.height) && (code.channels == 1 || code.channels == 3) &&
          num_samples(code) <= kMostSamples,
      kBadPrediction,
      "{}: a picture of {}x{} pixels with {} channels; the file is damaged",
      where,
      code.width,
      code.height,
      code.channels
  );
  const ImageSize size{code.width, code.height};
  std::vector<std::uint32_t> samples(num_samples(code));
  SampleDecoder decoder(format_of(code.channels), code.coded);
  GLINT_CHECK(
      decoder.read(size, samples) && decoder.ended_well(),
      kBadPrediction,
      "{}: its {} bytes are no picture of {}x{} pixels; the file is damaged",
      where,
      code.coded.size(),
      code.width,
      code.height
  );
  ByteImage image(code.width, code.height, code.channels);
  std::transform(samples.begin(), samples.end(), image.values().begin(), [](std::uint32_t sample) {
    return static_cast<unsigned char>(sample);
  });
  code.pixels.assign(image.values().begin(), image.values().end());
  const TemporaryFolder folder("glint-parcel");
  write_png(folder / "picture.png", ByteView(image));
  return read_file(folder / "picture.png");
}

}  // namespace glint
