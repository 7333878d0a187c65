// SPDX-License-Identifier: MIT
#include "datasets/map_resize.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "glint/core/parallel.h"
#include "glint/core/vec.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

// Overlap of new pixel `i` with the old pixels [first, last) of one axis.
struct Overlap {
  double begin, end;
  int first, last;
  Overlap(int i, int new_extent, int old_extent)
      : begin(static_cast<double>(i) * old_extent / new_extent),
        end(static_cast<double>(i + 1) * old_extent / new_extent),
        first(static_cast<int>(begin)),
        last(std::min(static_cast<int>(std::ceil(end)), old_extent)) {}
  double weight(int old) const {
    return std::min(end, static_cast<double>(old + 1)) - std::max(begin, static_cast<double>(old));
  }
};

struct Sample {
  double inverse_depth, weight;
};

// Depth of the surface at the weighted median; samples within 5 % of it belong to it.
float depth_of_main_surface(std::vector<Sample>& samples, double valid_weight) {
  constexpr double kSameSurface = 0.05;
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return a.inverse_depth < b.inverse_depth;
  });
  double passed = 0, median = 0;
  for (const Sample& sample : samples) {
    median = sample.inverse_depth;
    passed += sample.weight;
    if (passed >= 0.5 * valid_weight) break;
  }
  double sum = 0, weight = 0;
  for (const Sample& sample : samples) {
    if (std::abs(sample.inverse_depth - median) > kSameSurface * median) continue;
    sum += sample.weight * sample.inverse_depth;
    weight += sample.weight;
  }
  return static_cast<float>(weight / sum);
}

float resized_depth_at(ImageView depth, const Overlap& columns, const Overlap& rows) {
  std::vector<Sample> samples;
  double area = 0, valid = 0;
  for (int y = rows.first; y < rows.last; ++y)
    for (int x = columns.first; x < columns.last; ++x) {
      const double weight = columns.weight(x) * rows.weight(y);
      const float z = depth.at(x, y);
      area += weight;
      if (!(z > 0)) continue;
      valid += weight;
      samples.push_back({1 / static_cast<double>(z), weight});
    }
  return valid < 0.5 * area ? 0.0f : depth_of_main_surface(samples, valid);
}

}  // namespace

Image resize_depth(ImageView depth, ImageSize size) {
  Image result(size.width, size.height, 1);
  parallel_for(static_cast<std::size_t>(size.height), 8, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const Overlap rows(y, size.height, depth.height);
    for (int x = 0; x < size.width; ++x)
      result.at(x, y) = resized_depth_at(depth, Overlap(x, size.width, depth.width), rows);
  });
  return result;
}

Image resize_normal(ImageView normal, ImageSize size) {
  constexpr float kMissing = 0.25f;  // shorter means: mostly missing, or opposite directions
  Image result = resize_image(normal, size);
  for (std::size_t i = 0; i < result.num_pixels(); ++i) {
    float* n = result.data() + 3 * i;
    const float norm = length(Vec3f{n[0], n[1], n[2]});
    for (int c = 0; c < 3; ++c) n[c] = norm < kMissing ? 0 : n[c] / norm;
  }
  return result;
}

MaskImage resize_mask(MaskView mask, ImageSize size) {
  Image share(mask.width, mask.height, 1);
  for (std::size_t i = 0; i < mask.num_pixels(); ++i) share.data()[i] = mask.data[i] != 0 ? 1 : 0;
  share = resize_image(share, size);
  MaskImage result(size.width, size.height, 1);
  for (std::size_t i = 0; i < result.num_pixels(); ++i)
    result.data()[i] = share.data()[i] >= 0.5f ? 255 : 0;
  return result;
}

}  // namespace glint
