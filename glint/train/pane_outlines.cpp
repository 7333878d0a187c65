// SPDX-License-Identifier: MIT
#include "glint/train/pane_outlines.h"

#include <algorithm>
#include <cmath>

#include "glint/core/evenly_chosen.h"

namespace glint {

namespace {

constexpr int kScan = 40;              // steps forth and back
constexpr double kStep = 0.1;          // tolerances
constexpr std::size_t kFar = 16;       // steps from where agreement is best
constexpr double kLeast = 0.6;         // agreement of a rectangle with its outlines
constexpr double kLeastDrop = 0.08;    // of agreement, so far away on either side
constexpr double kNearly = 0.01;       // of agreement: as good
constexpr std::size_t kPoints = 1000;  // that a rectangle is fitted to, while it is placed

bool sees(const OutlinePixel& pixel, const MirrorPlane& plane) {
  const double away = plane.signed_distance(pixel.eye), towards = dot(plane.normal, pixel.ray);
  if (away <= 0 || towards >= 0) return false;
  return plane.holds(pixel.eye - (away / towards) * pixel.ray);
}

PlaneOfPoints moved(const PlaneOfPoints& fitted, double forth) {
  PlaneOfPoints result = fitted;
  result.plane.center += forth * fitted.plane.normal;
  fit_rectangle(result);
  return result;
}

PlaneOfPoints with_fewer_points(const PlaneOfPoints& fitted) {
  PlaneOfPoints result{fitted.plane, {}};
  for (const std::size_t i : evenly_chosen(kPoints, fitted.points.size()))
    result.points.push_back(fitted.points[i]);
  return result;
}

// The middle of where agreement is about best.
std::size_t middle_of_best(const std::vector<double>& agreements, std::size_t best) {
  const double least = agreements[best] - kNearly;
  std::size_t first = best, last = best;
  while (first > 0 && agreements[first - 1] >= least) --first;
  while (last + 1 < agreements.size() && agreements[last + 1] >= least) ++last;
  return (first + last) / 2;
}

// Highest where it is far below on either side.
bool is_peak(const std::vector<double>& agreements, std::size_t at) {
  if (at < kFar || at + kFar >= agreements.size()) return false;
  const double far = std::max(agreements[at - kFar], agreements[at + kFar]);
  return agreements[at] >= kLeast && agreements[at] - far >= kLeastDrop;
}

}  // namespace

double PaneOutlines::agreement(const MirrorPlane& plane) const {
  double seen = 0, agreeing = 0;
  for (const OutlinePixel& pixel : pixels_) {
    if (!sees(pixel, plane)) continue;
    seen += 1;
    agreeing += pixel.dark && dot(pixel.normal, plane.normal) >= settings_.min_cosine;
  }
  return seen > 0 ? agreeing / seen : 0;
}

double PaneOutlines::place(PlaneOfPoints& fitted) const {
  const PlaneOfPoints few = with_fewer_points(fitted);
  const double step = kStep * settings_.tolerance;
  std::vector<double> agreements;
  for (int k = -kScan; k <= kScan; ++k) agreements.push_back(agreement(moved(few, k * step).plane));
  const auto best = std::max_element(agreements.begin(), agreements.end()) - agreements.begin();
  const std::size_t at = middle_of_best(agreements, static_cast<std::size_t>(best));
  if (!is_peak(agreements, at)) return 0;
  fitted = moved(fitted, (static_cast<int>(at) - kScan) * step);
  return agreements[at];
}

}  // namespace glint
