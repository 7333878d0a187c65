// SPDX-License-Identifier: MIT
#include "reports/show/figures/map_crops.h"

#include <algorithm>
#include <cstdio>

#include "glint/core/error.h"
#include "glint/drawing/picture_grid.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr int kCropParts = 4;   // a crop is this part of the picture's width and height
constexpr int kCropSteps = 24;  // places tried along each side
constexpr int kOutline = 2;     // pixels
constexpr std::array<float, 3> kOnGlass{1.0f, 0.55f, 0.0f}, kOffGlass{0.2f, 0.75f, 1.0f};
constexpr std::array<std::array<float, 3>, kMaxCrops> kChosen{
    kOnGlass, kOffGlass, {0.35f, 0.85f, 0.3f}};
constexpr std::array<float, 3> kBlack{};

// Summed over the methods, 0 where a pixel does not count; whether any does.
bool sum_errors(
    const std::vector<const Image*>& errors, const MaskImage& glass, bool on_glass, Image& sum
) {
  bool any = false;
  for (std::size_t i = 0; i < sum.values().size(); ++i) {
    if ((!glass.empty() && glass.values()[i] != 0) != on_glass) continue;
    any = true;
    for (const Image* map : errors) sum.values()[i] += map->values()[i];
  }
  return any;
}

double window_sum(const Image& error, const Crop& crop) {
  double sum = 0;
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x)
      sum += static_cast<double>(error.at(crop.left + x, crop.top + y));
  return sum;
}

Image cropped(const Image& picture, const Crop& crop) {
  Image part(crop.width, crop.height, picture.channels());
  for (int y = 0; y < crop.height; ++y)
    std::copy_n(
        picture.pixel(crop.left, crop.top + y), crop.width * picture.channels(), part.pixel(0, y)
    );
  return part;
}

// The border of a box, `inset` pixels inside of its edge, as far as the picture reaches.
void draw_border(Image& picture, const Crop& box, int inset, int thickness, const float* color) {
  const int left = box.left + inset, right = box.left + box.width - 1 - inset;
  const int top = box.top + inset, bottom = box.top + box.height - 1 - inset;
  const auto near_edge = [&](int at, int low, int high) {
    return at < low + thickness || at > high - thickness;
  };
  for (int y = std::max(top, 0); y <= std::min(bottom, picture.height() - 1); ++y)
    for (int x = std::max(left, 0); x <= std::min(right, picture.width() - 1); ++x)
      if (near_edge(x, left, right) || near_edge(y, top, bottom))
        std::copy_n(color, 3, picture.pixel(x, y));
}

}  // namespace

Crop parse_crop(const std::string& text, std::size_t index) {
  GLINT_CHECK(index < kMaxCrops, kUsage, "--crop {}: at most {} crops fit", text, kMaxCrops);
  Crop crop;
  char end = 0;
  const int read = std::sscanf(
      text.c_str(), "%d,%d,%d,%d%c", &crop.left, &crop.top, &crop.width, &crop.height, &end
  );
  GLINT_CHECK(
      read == 4 && crop.left >= 0 && crop.top >= 0 && crop.width > 0 && crop.height > 0,
      kUsage,
      "--crop {}: expected x,y,width,height in pixels of the view, such as 40,20,32,18",
      text
  );
  crop.color = kChosen[index];
  return crop;
}

std::optional<Crop> crop_of_errors(
    const std::vector<const Image*>& errors, const MaskImage& glass, bool on_glass
) {
  if (errors.empty()) return std::nullopt;
  const int width = errors[0]->width(), height = errors[0]->height();
  Image sum(width, height, 1);
  if (!sum_errors(errors, glass, on_glass, sum)) return std::nullopt;
  Crop crop{0, 0, std::max(1, width / kCropParts), std::max(1, height / kCropParts)}, best = crop;
  double most = -1;
  for (int j = 0; j <= kCropSteps; ++j)
    for (int i = 0; i <= kCropSteps; ++i) {
      crop.left = (width - crop.width) * i / kCropSteps;
      crop.top = (height - crop.height) * j / kCropSteps;
      const double error = window_sum(sum, crop);
      if (error > most) best = crop;
      most = std::max(most, error);
    }
  return best;
}

std::vector<Crop> choose_crops(const std::vector<const Image*>& errors, const MaskImage& glass) {
  std::vector<Crop> crops;
  for (const bool on_glass : {true, false})
    if (auto crop = crop_of_errors(errors, glass, on_glass)) {
      crop->color = on_glass ? kOnGlass : kOffGlass;
      crops.push_back(*crop);
    }
  return crops;
}

Image outlined(const Image& picture, const std::vector<Crop>& crops) {
  if (picture.empty()) return {};
  Image panel = fit_panel(picture);  // enlarged first, so that lines have one width in all panels
  const auto scaled = [&](int value) { return value * panel.width() / picture.width(); };
  for (const Crop& crop : crops) {
    const Crop box{scaled(crop.left), scaled(crop.top), scaled(crop.width), scaled(crop.height)};
    draw_border(panel, box, -1, kOutline + 2, kBlack.data());  // seen on any colour
    draw_border(panel, box, 0, kOutline, crop.color.data());
  }
  return panel;
}

Image crop_panel(const Image& picture, const std::vector<Crop>& crops) {
  if (picture.empty() || crops.empty()) return {};
  const int count = static_cast<int>(crops.size()), gap = 2 * kOutline;
  const int width = (fit_panel(picture).width() - (count - 1) * gap) / count;
  const int height = std::max(1, crops[0].height * width / crops[0].width);
  Image panel(count * width + (count - 1) * gap, height, 3, 1.0f);
  for (int i = 0; i < count; ++i) {
    const Crop& crop = crops[static_cast<std::size_t>(i)];
    Image part = resize_image(cropped(picture, crop), {width, height});
    draw_border(part, {0, 0, width, height}, 0, kOutline, crop.color.data());
    for (int y = 0; y < height; ++y)
      std::copy_n(part.pixel(0, y), 3 * width, panel.pixel(i * (width + gap), y));
  }
  return panel;
}

}  // namespace glint
