// SPDX-License-Identifier: MIT
#include "glint/train/mirror_likeness.h"

#include <algorithm>
#include <cmath>

#include "glint/core/correlation.h"

namespace glint {

namespace {

constexpr int kWindows = 3;                 // along an image's height
constexpr double kLeastSeen = 0.75;         // of a window's pixels
constexpr double kLeastVariance = 1e-4;     // of a window of a photo: flatter ones say nothing
constexpr double kLeastUnexplained = 1e-9;  // of a variance, by k_s

// A window of a photo and of what the camera in the mirror sees.
struct Window {
  std::vector<double> photo, mirrored;
};

double sum_of(Vec3f v) { return static_cast<double>(v.x + v.y + v.z); }

}  // namespace

void MirrorLikeness::add(const View& view, const MirrorView& mirror) {
  const ImageSize size = view.camera.size();
  const int side = std::max(4, size.height / kWindows);
  for (int y = 0; y + side <= size.height; y += side)
    for (int x = 0; x + side <= size.width; x += side) add_window(view, mirror, x, y, side);
}

void MirrorLikeness::tell(MirrorPlane& plane, std::size_t least_windows) const {
  plane.likeness = correlations_.size() < least_windows ? 0 : mean_of(correlations_);
  for (std::size_t c = 0; c < 3; ++c)
    plane.tint[c] =
        static_cast<float>(mirrored_[c] > 0 ? std::min(1.0, photo_[c] / mirrored_[c]) : 1);
}

void MirrorLikeness::add_window(
    const View& view, const MirrorView& mirror, int left, int top, int side
) {
  Window window;
  const int width = view.camera.width;
  for (int y = top; y < top + side; ++y)
    for (int x = left; x < left + side; ++x) {
      if (mirror.seen().at(x, y) <= 0) continue;
      const Vec3f a = get3(view.rgb.pixel(x, y), 0);
      const Vec3f b = get3(mirror.picture().pixel(width - 1 - x, y), 0);
      window.photo.push_back(static_cast<double>(a.x + a.y + a.z) / 3);
      window.mirrored.push_back(static_cast<double>(b.x + b.y + b.z) / 3);
      for (int c = 0; c < 3; ++c) {
        photo_[static_cast<std::size_t>(c)] += static_cast<double>(a[c]);
        mirrored_[static_cast<std::size_t>(c)] += static_cast<double>(b[c]);
      }
    }
  if (static_cast<double>(window.photo.size()) < kLeastSeen * side * side) return;
  if (covariance(window.photo, window.photo) < kLeastVariance) return;
  correlations_.push_back(correlation(window.photo, window.mirrored));
}

void PaneLikeness::add(const KnownView& known, const Image& seen, const Image& mirrored) {
  const ImageSize size = known.view->camera.size();
  const int side = std::max(4, size.height / kWindows);
  for (int y = 0; y < size.height; y += side)
    for (int x = 0; x < size.width; x += side) add_window(known, seen, mirrored, x, y, side);
}

double PaneLikeness::correlation_of(Quantity a, Quantity b) const {
  const double both = products_[a][a] * products_[b][b];
  return both > 0 ? products_[a][b] / std::sqrt(both) : 0;
}

double PaneLikeness::partial_correlation() const {
  const double of_left = correlation_of(kLeft, kShare),
               of_mirrored = correlation_of(kMirrored, kShare);
  const double rest = (1 - of_left * of_left) * (1 - of_mirrored * of_mirrored);
  if (rest < kLeastUnexplained) return 0;
  return (correlation_of(kLeft, kMirrored) - of_left * of_mirrored) / std::sqrt(rest);
}

void PaneLikeness::add_window(
    const KnownView& known, const Image& seen, const Image& mirrored, int left, int top, int side
) {
  const ImageSize size = known.view->camera.size();
  double n = 0, sums[kCount] = {}, products[kCount][kCount] = {};
  for (int y = top; y < std::min(top + side, size.height); ++y)
    for (int x = left; x < std::min(left + side, size.width); ++x) {
      if (seen.at(x, y) <= 0) continue;
      const float share = known.share.at(x, y);
      const double values[kCount] = {
          sum_of(get3(known.view->rgb.pixel(x, y), 0) - get3(known.without.pixel(x, y), 0)),
          sum_of(share * get3(mirrored.pixel(size.width - 1 - x, y), 0)),
          static_cast<double>(share)};
      n += 1;
      for (int a = 0; a < kCount; ++a) {
        sums[a] += values[a];
        for (int b = 0; b < kCount; ++b) products[a][b] += values[a] * values[b];
      }
    }
  if (n < 2) return;
  for (int a = 0; a < kCount; ++a)
    for (int b = 0; b < kCount; ++b) products_[a][b] += products[a][b] - sums[a] * sums[b] / n;
}

}  // namespace glint
