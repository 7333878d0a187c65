// SPDX-License-Identifier: MIT
#include "datasets/disparity_shift.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "datasets/known_surfaces.h"
#include "datasets/prior_maps.h"
#include "glint/core/error.h"
#include "glint/core/median.h"
#include "glint/core/parallel.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr std::size_t kFewestPairs = 20;
constexpr double kLeastCorrelation = 0.7;

struct Line {  // y = slope x + offset
  double slope = 0, offset = 0, correlation = 0;
};

// Over the pairs of `ids`.
Line least_squares(
    const std::vector<double>& x, const std::vector<double>& y, const std::vector<std::size_t>& ids
) {
  const auto count = static_cast<double>(ids.size());
  double mean_x = 0, mean_y = 0, xx = 0, yy = 0, xy = 0;
  for (const std::size_t i : ids) mean_x += x[i] / count, mean_y += y[i] / count;
  for (const std::size_t i : ids) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  if (!(xx > 0 && yy > 0)) return {};
  return {xy / xx, mean_y - xy / xx * mean_x, xy / std::sqrt(xx * yy)};
}

// The four fifths of all pairs that are nearest to the line.
std::vector<std::size_t> nearest_to(
    const Line& line, const std::vector<double>& x, const std::vector<double>& y
) {
  std::vector<std::size_t> ids(x.size());
  std::iota(ids.begin(), ids.end(), std::size_t{0});
  const auto distance = [&](std::size_t i) {
    return std::abs(line.slope * x[i] + line.offset - y[i]);
  };
  const std::size_t kept = ids.size() - ids.size() / 5;
  std::stable_sort(ids.begin(), ids.end(), [&](std::size_t a, std::size_t b) {
    return distance(a) < distance(b);
  });
  ids.resize(kept);
  return ids;
}

std::optional<DisparityFit> fit_view(const ViewSource& view, const KnownPoints& points) try {
  const MapRow& row = MapId("depth").row();
  const Image map = read_stored_prior(view, row);
  const Camera camera = resized(camera_at(view, picture_size(view)), map.size());
  std::vector<double> disparity, z;
  for (const KnownPixel& pixel : points.seen_by(camera)) {
    const auto value = static_cast<double>(map.at(pixel.x, pixel.y));
    if (!(value > 0)) continue;
    disparity.push_back(value);
    z.push_back(pixel.depth);
  }
  return fit_disparity(disparity, z);
} catch (const OutOfMemory&) {
  throw;
} catch (const Error&) {
  return std::nullopt;
}

}  // namespace

std::optional<DisparityFit> fit_disparity(
    const std::vector<double>& disparity, const std::vector<double>& z
) {
  constexpr int kRounds = 5;
  if (z.size() < kFewestPairs) return std::nullopt;
  std::vector<double> inverse(z.size());
  for (std::size_t i = 0; i < z.size(); ++i) inverse[i] = 1 / z[i];
  std::vector<std::size_t> all(z.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  Line line = least_squares(disparity, inverse, all);
  for (int round = 0; round < kRounds; ++round)
    line = least_squares(disparity, inverse, nearest_to(line, disparity, inverse));
  if (!(line.slope > 0 && line.correlation >= kLeastCorrelation)) return std::nullopt;
  return DisparityFit{line.slope, line.offset / line.slope};
}

void tell_disparity_shifts(SceneIndex& index) {
  const KnownPoints points(index.points);
  std::vector<std::optional<DisparityFit>> fits(index.views.size());
  if (!points.empty())
    parallel_for(index.views.size(), 1, [&](std::size_t i) {
      if (index.views[i].priors.has("depth")) fits[i] = fit_view(index.views[i], points);
    });
  std::vector<double> shifts;
  for (const auto& fit : fits)
    if (fit) shifts.push_back(fit->shift);
  const double otherwise = shifts.empty() ? 0 : upper_median(shifts);
  for (std::size_t i = 0; i < index.views.size(); ++i)
    index.views[i].prior_reading.disparity_shift =
        static_cast<float>(fits[i] ? fits[i]->shift : otherwise);
  index.prior_notes.push_back(
      shifts.empty() ? "disparity: no shift could be told from points; inverted as stored"
                     : fmt::format(
                           "disparity: shift told from points in {} of {} views, others take the "
                           "median, {:.4g}",
                           shifts.size(),
                           index.views.size(),
                           otherwise
                       )
  );
}

}  // namespace glint
