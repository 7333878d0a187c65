// SPDX-License-Identifier: MIT
#include "glint/scene/image_files.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "glint/core/error.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

constexpr std::int64_t kMaxSide = 65535;              // the limit of JPEG; no camera comes near
constexpr std::int64_t kHarmlessBytes = 256ll << 20;  // may be allocated on a header's word
// Above the ratio of any lossless codec here: deflate cannot exceed 1032, PIZ stays below 300.
constexpr std::int64_t kMaxCompression = 4096;

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return extension;
}

float largest_channel(const Image& image, std::size_t pixel) {
  const float* values = image.data() + pixel * static_cast<std::size_t>(image.channels());
  return *std::max_element(values, values + image.channels());
}

}  // namespace

namespace detail {

Image repeat_grey(const Image& grey, int channels) {
  Image image(grey.width(), grey.height(), channels);
  for (std::size_t i = 0; i < grey.values().size(); ++i)
    for (int c = 0; c < channels; ++c)
      image.data()[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] =
          grey.values()[i];
  return image;
}

void check_claimed_size(const fs::path& path, ClaimedSize size, std::size_t file_bytes) {
  GLINT_CHECK(
      size.width > 0 && size.height > 0 && size.channels > 0 && size.channels <= 1024,
      kBadReference,
      "{}: the header gives {} x {} pixels with {} channels; expected positive numbers",
      path.string(),
      size.width,
      size.height,
      size.channels
  );
  GLINT_CHECK(
      size.width <= kMaxSide && size.height <= kMaxSide,
      kBadReference,
      "{}: the header gives {} x {} pixels; expected at most {} a side",
      path.string(),
      size.width,
      size.height,
      kMaxSide
  );
  const std::int64_t bytes =
      size.width * size.height * size.channels * static_cast<std::int64_t>(sizeof(float));
  GLINT_CHECK(
      bytes <= kHarmlessBytes || bytes / kMaxCompression <= static_cast<std::int64_t>(file_bytes),
      kBadReference,
      "{}: the header gives {} x {} pixels with {} channels, too many for a file of {} bytes; the "
      "file is damaged, write it again",
      path.string(),
      size.width,
      size.height,
      size.channels,
      file_bytes
  );
}

void fail_incomplete(const fs::path& path, std::string_view format, std::string_view detail) {
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: not a complete {} file ({}); copy or write it again", path.string(), format, detail
      )
  );
}

}  // namespace detail

namespace {

// For what phones and cameras write.
std::string_view conversion_of(std::string_view extension) {
  for (const std::string_view phone : {".heic", ".heif", ".avif"})
    if (extension == phone) return "; heif-convert makes a PNG of it";
  for (const std::string_view raw : {".dng", ".cr2", ".cr3", ".nef", ".arw", ".raf", ".orf"})
    if (extension == raw) return "; a camera's raw file: darktable-cli or dcraw develops it";
  return "";
}

Image read_by_extension(const fs::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".exr") return detail::read_exr(path);
  if (extension == ".npy") return detail::read_npy(path);
  if (extension == ".tif" || extension == ".tiff") return read_tiff(path, std::nullopt);
  GLINT_CHECK(
      std::ranges::count(kPictureExtensions, extension) > 0,
      kBadReference,
      "{}: unknown image format '{}'; expected {}, .exr, .npy or .tiff{}",
      path.string(),
      extension,
      fmt::join(kPictureExtensions, ", "),
      conversion_of(extension)
  );
  return detail::read_picture(path);
}

}  // namespace

Image read_image(const fs::path& path) {
  return read_within_memory(path, [&] { return read_by_extension(path); });
}

Image read_image(const fs::path& path, int channels) {
  Image image = read_image(path);
  if (image.channels() == channels) return image;
  GLINT_CHECK(
      image.channels() == 1,
      kBadReference,
      "{}: {} channels, expected {}; convert the file to a single channel",
      path.string(),
      image.channels(),
      channels
  );
  return detail::repeat_grey(image, channels);
}

std::string color_range_problem(ImageView colors) {
  constexpr float kLeast = -1, kMost = 2;  // renders and ringing stay within
  if (colors.empty()) return {};
  const std::size_t count = static_cast<std::size_t>(colors.width) *
                            static_cast<std::size_t>(colors.height) *
                            static_cast<std::size_t>(colors.channels);
  const auto [least, most] = std::minmax_element(colors.data, colors.data + count);
  if (*least >= kLeast && *most <= kMost) return {};
  return fmt::format(
      "values from {:.4g} to {:.4g}, but colours as displayed lie in [0, 1]; divide bytes by 255, "
      "encode or clamp radiance",
      *least,
      *most
  );
}

MaskImage read_mask(const fs::path& path) {
  const Image image = read_image(path);
  MaskImage mask(image.width(), image.height(), 1);
  float largest = 0;
  for (std::size_t i = 0; i < image.num_pixels(); ++i) {
    const float value = largest_channel(image, i);
    largest = std::max(largest, value);
    mask.data()[i] = value >= 0.5f ? 255 : 0;
  }
  // A mask of 0 and 1 in 8 bits would silently select nothing.
  GLINT_CHECK(
      largest == 0 || largest >= 0.5f,
      kBadReference,
      "{}: the mask's largest value is {:.4g} of full range, so no pixel would count; save it with "
      "0 "
      "and full range (255 in 8 bits)",
      path.string(),
      largest
  );
  return mask;
}

}  // namespace glint
