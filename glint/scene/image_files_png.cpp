// SPDX-License-Identifier: MIT
// PNG and JPEG. Decoders report damage on standard error and hand out half-grey pictures, so the
// container is walked first: every chunk of a PNG, the headers of a JPEG.
#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

using namespace std::string_view_literals;
using detail::big_endian;
using detail::ClaimedSize;

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kJpegSignature = "\xff\xd8\xff"sv;

struct PictureHeader {
  ClaimedSize size;
  bool grey = false;
};

// IHDR, after checking that every chunk up to IEND lies inside the file.
PictureHeader walk_png(const fs::path& path, std::string_view file) {
  constexpr std::size_t kOverhead = 12;  // length, type, checksum
  std::size_t at = kPngSignature.size();
  while (true) {
    if (file.size() - at < kOverhead)
      detail::fail_incomplete(path, "PNG", "it ends inside a chunk");
    const std::size_t length = big_endian(file.substr(at, 4));
    if (file.size() - at - kOverhead < length)
      detail::fail_incomplete(path, "PNG", "it ends inside a chunk");
    if (file.substr(at + 4, 4) == "IEND") break;
    at += kOverhead + length;
  }
  if (file.substr(12, 4) != "IHDR" || at < 33)
    detail::fail_incomplete(path, "PNG", "it has no header");
  const int color_type = file[25];
  constexpr int kColorBit = 2;
  const bool grey = (color_type & kColorBit) == 0;
  return {{big_endian(file.substr(16, 4)), big_endian(file.substr(20, 4)), 4}, grey};
}

// The frame header (SOF0 ... SOF15), after checking that the file ends with an end marker.
PictureHeader walk_jpeg(const fs::path& path, std::string_view file) {
  const std::size_t end = file.find_last_not_of("\0\n\r "sv);
  if (end == std::string_view::npos || file.substr(end - 1, 2) != "\xff\xd9"sv)
    detail::fail_incomplete(path, "JPEG", "the end marker is missing");
  std::size_t at = 2;
  while (at + 9 < file.size() && static_cast<unsigned char>(file[at]) == 0xff) {
    const auto marker = static_cast<unsigned char>(file[at + 1]);
    const bool frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) {
      const int channels = file[at + 9];
      return {
          {big_endian(file.substr(at + 7, 2)), big_endian(file.substr(at + 5, 2)), channels},
          channels == 1};
    }
    at += marker == 0xff ? 1 : 2 + big_endian(file.substr(at + 2, 2));
  }
  detail::fail_incomplete(path, "JPEG", "it has no frame header");
}

PictureHeader walk(const fs::path& path, std::string_view file) {
  if (file.starts_with(kPngSignature)) return walk_png(path, file);
  if (file.starts_with(kJpegSignature)) return walk_jpeg(path, file);
  GLINT_CHECK(
      !file.empty(), kBadReference, "{}: the file is empty; expected a PNG or JPEG", path.string()
  );
  throw Error(
      ExitCode::kBadReference,
      fmt::format("{}: neither a PNG nor a JPEG, whatever its name says", path.string())
  );
}

// `grey` keeps one of the equal channels; alpha is dropped.
Image without_alpha(Image picture, bool grey) {
  const int stored = picture.channels(), kept = grey || stored < 3 ? 1 : 3;
  if (kept == stored) return picture;
  Image image(picture.width(), picture.height(), kept);
  const float* from = picture.data();
  float* to = image.data();
  for (std::size_t i = 0; i < image.num_pixels(); ++i, from += stored, to += kept)
    std::copy_n(from, kept, to);
  return image;
}

unsigned char to_byte(float value) {
  if (!(value > 0)) return 0;  // NaN too: the caller's metrics report it, a PNG cannot hold it
  return static_cast<unsigned char>(std::nearbyint(std::min(value, 1.0f) * 255.0f));
}

}  // namespace

Image detail::read_png_or_jpeg(const fs::path& path) {
  const std::string file = read_file(path);
  const PictureHeader header = walk(path, file);
  check_claimed_size(path, header.size, file.size());
  const bool is_png = file.starts_with(kPngSignature);
  return without_alpha(is_png ? decode_png(path, file) : decode_jpeg(path, file), header.grey);
}

ImageSize read_image_size(const fs::path& path) {
  const std::string file = read_file(path);
  const ClaimedSize size = walk(path, file).size;
  detail::check_claimed_size(path, size, file.size());
  return {static_cast<int>(size.width), static_cast<int>(size.height)};
}

void write_png(const fs::path& path, ImageView image) {
  GLINT_CHECK(
      !image.empty() && (image.channels == 1 || image.channels == 3),
      kUsage,
      "{}: cannot write a PNG of {} x {} pixels with {} channels; expected 1 or 3 channels",
      path.string(),
      image.width,
      image.height,
      image.channels
  );
  MaskImage bytes(image.width, image.height, image.channels);
  std::transform(image.data, image.data + bytes.values().size(), bytes.data(), to_byte);
  write_file(path, detail::encode_png(bytes));
}

}  // namespace glint
