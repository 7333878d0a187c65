// SPDX-License-Identifier: MIT
// Pictures of integers. Decoders report damage on standard error and hand out half-grey pictures,
// so the container is walked first: every chunk of a PNG, the headers of a JPEG. Nothing is
// allocated on the word of a header that the file cannot fill.
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
using detail::is_webp;

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kJpegSignature = "\xff\xd8\xff"sv;

bool is_bmp(std::string_view file) { return file.starts_with("BM"sv); }

// Each scan of a progressive picture is work for all of its pixels; encoders write about ten. The
// marker is no part of compressed data.
constexpr std::size_t kMostScans = 100;
constexpr std::string_view kScanMarker = "\xff\xda"sv;

std::size_t count_scans(std::string_view file) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = file.find(kScanMarker, at)) != std::string_view::npos; ++at)
    ++count;
  return count;
}

// The frame header (SOF0 ... SOF15), after checking that the file ends with an end marker.
ClaimedSize walk_jpeg(const fs::path& path, std::string_view file) {
  const std::size_t end = file.find_last_not_of("\0\n\r "sv);
  if (end == std::string_view::npos || file.substr(end - 1, 2) != "\xff\xd9"sv)
    detail::fail_incomplete(path, "JPEG", "the end marker is missing");
  if (const std::size_t scans = count_scans(file); scans > kMostScans)
    detail::fail_incomplete(
        path, "JPEG", fmt::format("{} scans, expected at most {}", scans, kMostScans)
    );
  std::size_t at = 2;
  while (at + 9 < file.size() && static_cast<unsigned char>(file[at]) == 0xff) {
    const auto marker = static_cast<unsigned char>(file[at + 1]);
    const bool frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) {
      return {big_endian(file.substr(at + 7, 2)), big_endian(file.substr(at + 5, 2)), file[at + 9]};
    }
    at += marker == 0xff ? 1 : 2 + big_endian(file.substr(at + 2, 2));
  }
  detail::fail_incomplete(path, "JPEG", "it has no frame header");
}

ClaimedSize claimed_size(const fs::path& path, std::string_view file) {
  if (file.starts_with(kPngSignature)) return detail::png_size(path, file);
  if (file.starts_with(kJpegSignature)) return walk_jpeg(path, file);
  if (is_webp(file)) return detail::webp_size(path, file);
  if (is_bmp(file)) return detail::bmp_size(path, file);
  GLINT_CHECK(
      !file.empty(), kBadReference, "{}: the file is empty; expected a picture", path.string()
  );
  throw Error(
      ExitCode::kBadReference,
      fmt::format("{}: neither PNG, JPEG, WebP nor BMP, whatever its name says", path.string())
  );
}

// The nearest of the steps 0 ... max(T) of [0, 1].
template <class T>
T to_step(float value) {
  if (!(value > 0)) return 0;  // NaN too: the caller's metrics report it, a PNG cannot hold it
  constexpr auto kMax = static_cast<float>(std::numeric_limits<T>::max());
  return static_cast<T>(std::nearbyint(std::min(value, 1.0f) * kMax));
}

}  // namespace

Image detail::read_picture(const fs::path& path, std::optional<float> background) {
  const std::string file = read_file(path);
  check_claimed_size(path, claimed_size(path, file), file.size());
  if (is_webp(file)) return decode_webp(path, file, background);
  if (is_bmp(file)) return decode_bmp(path, file);
  return file.starts_with(kPngSignature) ? decode_png(path, file, background)
                                         : decode_jpeg(path, file);
}

ImageSize read_image_size(const fs::path& path) {
  const std::string file = read_file(path);
  const ClaimedSize size = claimed_size(path, file);
  detail::check_claimed_size(path, size, file.size());
  return {static_cast<int>(size.width), static_cast<int>(size.height)};
}

ByteImage to_bytes(ImageView image) {
  ByteImage bytes(image.width, image.height, image.channels);
  std::
      transform(image.data, image.data + bytes.values().size(), bytes.data(), to_step<unsigned char>);
  return bytes;
}

void write_png(const fs::path& path, ByteView image) {
  GLINT_CHECK(
      !image.empty() && (image.channels == 1 || image.channels == 3),
      kUsage,
      "{}: cannot write a PNG of {} x {} pixels with {} channels; expected 1 or 3 channels",
      path.string(),
      image.width,
      image.height,
      image.channels
  );
  write_file(path, detail::encode_png(image));
}

void write_png(const fs::path& path, ImageView image) { write_png(path, to_bytes(image)); }

void write_png16(const fs::path& path, ImageView grey) {
  GLINT_CHECK(
      !grey.empty() && grey.channels == 1,
      kUsage,
      "{}: cannot write a 16-bit PNG of {} channels; expected 1",
      path.string(),
      grey.channels
  );
  std::vector<std::uint16_t> steps(grey.num_pixels());
  std::transform(grey.data, grey.data + steps.size(), steps.begin(), to_step<std::uint16_t>);
  write_file(path, detail::encode_png16(grey.size(), steps.data()));
}

}  // namespace glint
