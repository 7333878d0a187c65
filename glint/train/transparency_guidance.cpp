// SPDX-License-Identifier: MIT
#include "glint/train/transparency_guidance.h"

#include <algorithm>
#include <cmath>

#include "glint/train/pixel_sums.h"

namespace glint {

namespace {

constexpr float kCos70 = 0.342020143f, kCos80 = 0.173648178f;

float mean_rgb(ImageView image, int x, int y) {
  const float* p = image.pixel(x, y);
  return (p[0] + p[1] + p[2]) / 3;
}

struct PixelLabel {
  bool transparent = false, opaque = false;
};

PixelLabel label_l1(const TransparencyGuidance& g, const TransparencyCues& cues, int x, int y) {
  const float z = cues.interface_depth.at(x, y), behind = cues.transmission_depth.at(x, y);
  const bool apart = z > 0 && behind > 0 && std::abs(z - behind) > g.depth_threshold;
  const bool transparent = apart && mean_rgb(cues.albedo, x, y) < g.low_albedo;
  return {transparent, !transparent};
}

PixelLabel label_bce(const TransparencyGuidance& g, const TransparencyCues& cues, int x, int y) {
  const float z = cues.interface_depth.at(x, y), behind = cues.transmission_depth.at(x, y);
  const float albedo = mean_rgb(cues.albedo, x, y);
  const bool is_low = albedo<g.low_albedo, is_high = albedo> g.high_albedo;
  const bool is_bright = mean_rgb(cues.basecolor, x, y) > g.bright_basecolor;
  const bool is_behind = behind > z + g.depth_threshold;
  return {
      is_low && is_bright && z > 0 && behind > 0 && is_behind,
      is_high || (is_low && !is_bright) || !is_behind};
}

template <class LabelAt>
TransparencyMasks label_pixels(ImageSize size, const LabelAt& label_at) {
  TransparencyMasks masks{Image(size.width, size.height, 1), Image(size.width, size.height, 1)};
  parallel_for(size.height, 8, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < size.width; ++x) {
      const PixelLabel label = label_at(x, y);
      masks.transparent.at(x, y) = label.transparent ? 1.0f : 0.0f;
      masks.opaque.at(x, y) = label.opaque ? 1.0f : 0.0f;
    }
  });
  return masks;
}

// Minimum over the 3x3 neighbours inside the image.
float eroded_at(const Image& mask, int x, int y) {
  float least = mask.at(x, y);
  for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, mask.height() - 1); ++ny)
    for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, mask.width() - 1); ++nx)
      least = std::min(least, mask.at(nx, ny));
  return least;
}

Image erode_and_weight(const Image& mask, ImageView cosine) {
  Image result(mask.width(), mask.height(), 1);
  parallel_for(mask.height(), 8, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < mask.width(); ++x) {
      const float c = cosine.num_pixels() == 0 ? 1.0f : cosine.at(x, y);
      const float angle_weight = std::clamp((c - kCos80) / (kCos70 - kCos80), 0.0f, 1.0f);
      result.at(x, y) = angle_weight * eroded_at(mask, x, y);
    }
  });
  return result;
}

template <class T>
double mean_l1(const BasicImage<T>& t, const Image& target, T weight, BasicImage<T>& dL_dt) {
  const auto num_pixels = static_cast<double>(t.num_pixels());
  const T scale = weight / static_cast<T>(num_pixels);
  const double sum = sum_over_pixels(t.size(), [&](int x, int y) {
    const T difference = t.at(x, y) - static_cast<T>(target.at(x, y));
    dL_dt.at(x, y) += scale * sign_of(difference);
    return static_cast<double>(abs_of(difference));
  });
  return sum / num_pixels;
}

// sum m BCE(t, target) / sum m, 0 for an empty mask.
template <class T>
double mean_bce(
    const BasicImage<T>& t, const Image& mask, T target, T weight, BasicImage<T>& dL_dt
) {
  const double mask_sum =
      sum_over_pixels(t.size(), [&](int x, int y) { return static_cast<double>(mask.at(x, y)); });
  if (!(mask_sum > 0)) return 0;
  const T scale = weight / static_cast<T>(mask_sum);
  const double sum = sum_over_pixels(t.size(), [&](int x, int y) {
    const T m = static_cast<T>(mask.at(x, y));
    binary_cross_entropy_vjp(t.at(x, y), target, scale * m, dL_dt.at(x, y));
    return static_cast<double>(m * binary_cross_entropy(t.at(x, y), target));
  });
  return sum / mask_sum;
}

}  // namespace

TransparencyMasks TransparencyGuidance::masks(const TransparencyCues& cues) const {
  const ImageSize size = cues.interface_depth.size();
  const bool is_bce = kind == GuidanceKind::kBce;
  if (size.num_pixels() == 0 || cues.transmission_depth.num_pixels() == 0 ||
      cues.albedo.num_pixels() == 0 || (is_bce && cues.basecolor.num_pixels() == 0))
    return {};
  check_fits("depth of the transmission", cues.transmission_depth, size, 1);
  check_fits("albedo prior", cues.albedo, size, 3);
  if (!is_bce) return label_pixels(size, [&](int x, int y) { return label_l1(*this, cues, x, y); });
  check_fits("basecolor prior", cues.basecolor, size, 3);
  if (cues.cosine.num_pixels() > 0) check_fits("viewing cosines", cues.cosine, size, 1);
  const TransparencyMasks labels =
      label_pixels(size, [&](int x, int y) { return label_bce(*this, cues, x, y); });
  return {
      erode_and_weight(labels.transparent, cues.cosine),
      erode_and_weight(labels.opaque, cues.cosine)};
}

template <class T>
double TransparencyGuidance::evaluate(
    const BasicImage<T>& transparency,
    const TransparencyMasks& masks,
    T weight,
    BasicImage<T>& dL_dtransparency
) const {
  if (masks.transparent.empty()) return 0;
  check_fits("transparency mask", masks.transparent, transparency.size(), 1);
  if (kind == GuidanceKind::kL1)
    return mean_l1(transparency, masks.transparent, weight, dL_dtransparency);
  check_fits("opacity mask", masks.opaque, transparency.size(), 1);
  const T high = static_cast<T>(transparent_target), low = static_cast<T>(opaque_target);
  return mean_bce(transparency, masks.transparent, high, weight, dL_dtransparency) +
         mean_bce(transparency, masks.opaque, low, weight, dL_dtransparency);
}

Image viewing_cosines(const Camera& camera, const Image& normal) {
  Image cosines(normal.width(), normal.height(), 1);
  parallel_for(normal.height(), 8, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < normal.width(); ++x) {
      const Vec3f ray = cast<float>(normalize(camera.ray_in_cam(x + 0.5, y + 0.5)));
      cosines.at(x, y) = std::abs(dot(unit_normal(load3<float>(normal, x, y)), ray));
    }
  });
  return cosines;
}

template double
TransparencyGuidance::evaluate(const Image&, const TransparencyMasks&, float, Image&) const;
template double TransparencyGuidance::
    evaluate(const BasicImage<double>&, const TransparencyMasks&, double, BasicImage<double>&)
        const;

}  // namespace glint
