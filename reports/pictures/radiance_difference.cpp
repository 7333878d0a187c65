// SPDX-License-Identifier: MIT
#include "reports/pictures/radiance_difference.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/drawing/color_maps.h"
#include "glint/scene/image_files.h"
#include "reports/pictures/difference_page.h"

namespace glint {

namespace {

constexpr int kBlock = 8;             // pixels
constexpr int kRadius = 2;            // of the means in the picture
constexpr float kFarBrighter = 1e6f;  // relative difference to black

double channel_sum(ImageView image, int x, int y) {
  const float* rgb = image.pixel(x, y);
  return static_cast<double>(rgb[0]) + static_cast<double>(rgb[1]) + static_cast<double>(rgb[2]);
}

// Over a rectangle that is cut off at the border.
double mean_around(ImageView image, int left, int top, int size) {
  double sum = 0;
  int count = 0;
  for (int y = std::max(top, 0); y < std::min(top + size, image.height); ++y)
    for (int x = std::max(left, 0); x < std::min(left + size, image.width); ++x, ++count)
      sum += channel_sum(image, x, y);
  return sum / std::max(count, 1);
}

void add_blocks(ImageView first, ImageView second, RadianceDifference& difference) {
  for (int y = 0; y + kBlock <= first.height; y += kBlock)
    for (int x = 0; x + kBlock <= first.width; x += kBlock) {
      const double a = mean_around(first, x, y, kBlock), b = mean_around(second, x, y, kBlock);
      if (a <= 0) continue;
      difference.block_squares += (b / a - 1) * (b / a - 1);
      ++difference.blocks;
    }
}

Image displayed(ImageView radiance) {
  Image image(radiance.width, radiance.height, 3);
  for (std::size_t i = 0; i < image.values().size(); ++i)
    image.values()[i] = std::clamp(srgb_encode(radiance.data[i]), 0.0f, 1.0f);
  return image;
}

std::vector<bool> glass_of(const fs::path& folder, const std::string& view, ImageSize size) {
  const fs::path file = folder / "gt" / "glass" / (view + ".png");
  std::error_code code;
  if (!fs::exists(file, code)) return {};
  const MaskImage mask = read_mask(file);
  GLINT_CHECK(
      mask.size() == size,
      kBadReference,
      "{}: {} x {} pixels, but the view has {} x {}",
      file.string(),
      mask.width(),
      mask.height(),
      size.width,
      size.height
  );
  return {mask.values().begin(), mask.values().end()};
}

std::vector<std::string> common_views(const fs::path& first, const fs::path& second) {
  const fs::path radiance = fs::path("gt") / "rgb";
  std::vector<std::string> names;
  std::error_code code;
  for (const fs::path& file : list_files(first / radiance, {".exr"}))
    if (fs::exists(second / radiance / file.filename(), code)) names.push_back(file.stem());
  GLINT_CHECK(
      !names.empty(),
      kBadReference,
      "{}: none of its gt/rgb/<view>.exr is in {}, too; expected two renderings of one scene",
      first.string(),
      second.string()
  );
  return names;
}

}  // namespace

RadianceSums& RadianceSums::operator+=(const RadianceSums& other) {
  first += other.first;
  second += other.second;
  pixels += other.pixels;
  return *this;
}

std::optional<double> RadianceSums::ratio() const {
  if (first <= 0) return std::nullopt;
  return second / first;
}

RadianceDifference& RadianceDifference::operator+=(const RadianceDifference& other) {
  opaque += other.opaque;
  glass += other.glass;
  block_squares += other.block_squares;
  blocks += other.blocks;
  return *this;
}

RadianceSums RadianceDifference::all() const {
  RadianceSums sums = opaque;
  return sums += glass;
}

std::optional<double> RadianceDifference::block_rms() const {
  if (blocks == 0) return std::nullopt;
  return std::sqrt(block_squares / static_cast<double>(blocks));
}

RadianceDifference radiance_difference(
    ImageView first, ImageView second, const std::vector<bool>& glass
) {
  RadianceDifference difference;
  for (int y = 0; y < first.height; ++y)
    for (int x = 0; x < first.width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(first.width) +
                     static_cast<std::size_t>(x);
      RadianceSums& region = !glass.empty() && glass[i] ? difference.glass : difference.opaque;
      region += {channel_sum(first, x, y), channel_sum(second, x, y), 1};
    }
  add_blocks(first, second, difference);
  return difference;
}

Image relative_difference(ImageView first, ImageView second) {
  constexpr int kSize = 2 * kRadius + 1;
  Image relative(first.width, first.height, 1);
  for (int y = 0; y < first.height; ++y)
    for (int x = 0; x < first.width; ++x) {
      const double a = mean_around(first, x - kRadius, y - kRadius, kSize);
      const double b = mean_around(second, x - kRadius, y - kRadius, kSize);
      relative.at(x, y) = a > 0 ? static_cast<float>(b / a - 1) : b > 0 ? kFarBrighter : 0.0f;
    }
  return relative;
}

std::vector<ComparedView> compare_renderings(
    const fs::path& first, const fs::path& second, const fs::path& picture, float range
) {
  std::vector<ComparedView> compared;
  DifferencePage page{first.string(), second.string(), range, {}};
  for (const std::string& view : common_views(first, second)) {
    const fs::path file = fs::path("gt") / "rgb" / (view + ".exr");
    const Image a = read_image(first / file, 3), b = read_image(second / file, 3);
    GLINT_CHECK(
        a.size() == b.size(),
        kBadReference,
        "{}: {} x {} pixels, but {} has {} x {}; render both at one size",
        (second / file).string(),
        b.width(),
        b.height(),
        (first / file).string(),
        a.width(),
        a.height()
    );
    compared.push_back({view, radiance_difference(a, b, glass_of(first, view, a.size()))});
    if (picture.empty()) continue;
    page.rows.push_back(
        {view, displayed(a), displayed(b), colorize_signed(relative_difference(a, b), range)}
    );
  }
  if (!picture.empty()) write_difference_page(picture, page);
  return compared;
}

}  // namespace glint
