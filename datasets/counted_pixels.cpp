// SPDX-License-Identifier: MIT
#include "datasets/counted_pixels.h"

#include <algorithm>
#include <cmath>

#include "datasets/map_resize.h"
#include "glint/core/error.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr float kGrey = 0.5f;

void check_shape(const fs::path& path, ImageSize mask, ImageSize image) {
  // One pixel of rounding in either side is what resizing tools leave.
  const double slack = std::abs(
      static_cast<double>(mask.width) * image.height -
      static_cast<double>(mask.height) * image.width
  );
  GLINT_CHECK(
      slack <= std::max(mask.width + mask.height, image.width + image.height),
      kBadReference,
      "{}: {} x {} pixels, its view's image has {} x {}; a mask has the image's shape",
      path.string(),
      mask.width,
      mask.height,
      image.width,
      image.height
  );
}

std::size_t num_counted(const Image& counted) {
  const auto values = counted.values();
  return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [](float v) {
    return v != 0;
  }));
}

void blank(const Image& counted, float value, Image& map) {
  const auto channels = static_cast<std::size_t>(map.channels());
  for (std::size_t i = 0; i < counted.num_pixels(); ++i)
    if (counted.data()[i] == 0) std::fill_n(map.data() + channels * i, channels, value);
}

// "3 of 40 train views (1.2 % of all their pixels)"; empty: none.
std::string note_of(const std::vector<View>& views, const char* split) {
  std::size_t with_mask = 0, left_out = 0, pixels = 0;
  for (const View& view : views) {
    pixels += view.rgb.num_pixels();
    if (view.counted.empty()) continue;
    ++with_mask;
    left_out += view.counted.num_pixels() - num_counted(view.counted);
  }
  if (with_mask == 0) return {};
  return fmt::format(
      "{} of {} {} views ({:.2g} % of all their pixels)",
      with_mask,
      views.size(),
      split,
      100 * static_cast<double>(left_out) / static_cast<double>(pixels)
  );
}

}  // namespace

Image read_counted(const fs::path& path, ImageSize size) {
  MaskImage mask = read_mask(path);
  check_shape(path, mask.size(), size);
  if (mask.size() != size) mask = resize_mask(mask, size);
  Image counted = map_of_mask(mask);
  GLINT_CHECK(
      num_counted(counted) > 0,
      kBadReference,
      "{}: no pixel counts, white is what does; leave the view out, or mend the mask",
      path.string()
  );
  return counted;
}

Image resize_counted(const Image& rgb, const Image& counted, ImageSize size) {
  Image kept = rgb;
  blank(counted, 0, kept);
  Image result = resize_image(kept, size);
  const Image share = resize_image(counted, size);
  for (std::size_t i = 0; i < result.num_pixels(); ++i)
    if (const float s = share.data()[i]; s > 0)
      for (int c = 0; c < 3; ++c) result.data()[3 * i + c] /= s;
  return result;
}

void blank_uncounted(View& view) {
  if (view.counted.empty()) return;
  const std::size_t count = num_counted(view.counted);
  GLINT_CHECK(
      count > 0, kBadReference, "{}: no pixel counts at this size; leave the view out", view.name
  );
  if (count == view.counted.num_pixels()) {
    view.counted = {};
    return;
  }
  blank(view.counted, kGrey, view.rgb);
  for (MapSet* maps : {&view.priors, &view.truth})
    maps->for_each([&](const MapRow& row, Image& map) {
      if (row.kind != MapKind::kMask) blank(view.counted, 0, map);
    });
}

std::string counted_note(const Scene& scene) {
  std::string note = note_of(scene.train, "train");
  const std::string test = note_of(scene.test, "test");
  if (!note.empty() && !test.empty()) note += " and ";
  note += test;
  return note.empty() ? note : "pixels that do not count, by masks: " + note;
}

}  // namespace glint
