// SPDX-License-Identifier: MIT
#include "metrics/tools/doubts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/middle.h"
#include "glint/core/vec.h"
#include "glint/scene/image_files_stored.h"
#include "metrics/length_units.h"
#include "metrics/normal.h"
#include "metrics/tools/normal_axes.h"

namespace glint {
namespace {

using Matrix4 = std::array<std::array<double, 4>, 4>;
using Turn = std::array<double, 4>;  // unit quaternion w x y z

// Sum over pixels of prediction n and reference m, as the matrix whose best eigenvector is the
// rotation that brings n nearest to m [Horn 1987].
Matrix4 correlation(ImageView prediction, ImageView reference) {
  double s[3][3] = {};
  for (std::size_t i = 0; i < prediction.num_pixels(); ++i) {
    const float *n = prediction.data + 3 * i, *m = reference.data + 3 * i;
    if (!std::isfinite(n[0] + n[1] + n[2] + m[0] + m[1] + m[2])) continue;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) s[a][b] += static_cast<double>(n[a]) * static_cast<double>(m[b]);
  }
  const double x = s[1][2] - s[2][1], y = s[2][0] - s[0][2], z = s[0][1] - s[1][0];
  return {
      {{s[0][0] + s[1][1] + s[2][2], x, y, z},
       {x, s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
       {y, s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]},
       {z, s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]}}};
}

// Of the largest eigenvalue, by powers of the matrix, shifted so that it is the largest in size,
// too.
Turn best_turn(Matrix4 matrix) {
  double shift = 0;
  for (const auto& row : matrix)
    for (const double value : row) shift += std::abs(value);
  for (std::size_t i = 0; i < 4; ++i) matrix[i][i] += shift;
  Turn turn{0.7, 0.5, 0.4, 0.3};
  for (int step = 0; step < 500; ++step) {
    Turn next{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) next[i] += matrix[i][j] * turn[j];
    const double norm =
        std::sqrt(next[0] * next[0] + next[1] * next[1] + next[2] * next[2] + next[3] * next[3]);
    if (!(norm > 0)) return {1, 0, 0, 0};
    for (double& value : next) value /= norm;
    turn = next;
  }
  return turn;
}

Vec3d turned(const Turn& q, Vec3d v) {
  const Vec3d u{q[1], q[2], q[3]};
  return v + 2 * q[0] * cross(u, v) + 2.0 * cross(u, cross(u, v));
}

Image copy_of(ImageView view) {
  Image image(view.width, view.height, view.channels);
  std::copy_n(view.data, image.values().size(), image.data());
  return image;
}

double mean_angle(ImageView prediction, ImageView reference) {
  const auto errors = normal_errors(prediction, reference);
  return errors ? errors->mean_deg : 0;
}

double angle_when_turned(ImageView prediction, ImageView reference) {
  const Turn turn = best_turn(correlation(prediction, reference));
  Image image = copy_of(prediction);
  for (std::size_t i = 0; i < image.num_pixels(); ++i) {
    float* n = image.data() + 3 * i;
    const Vec3d v = turned(
        turn, {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])}
    );
    for (int c = 0; c < 3; ++c) n[c] = static_cast<float>(v[c]);
  }
  return mean_angle(image, reference);
}

// As if the prediction's file had been read in other axes.
double angle_in_axes(
    ImageView prediction, ImageView reference, const Axes& found, const Axes& other
) {
  Image image = copy_of(prediction);
  for (std::size_t i = 0; i < image.values().size(); ++i)
    image.data()[i] *= found.to_opencv[i % 3] * other.to_opencv[i % 3];
  return mean_angle(image, reference);
}

}  // namespace

std::string depth_unit_doubt(ImageView prediction, ImageView reference) {
  const double ratio = median_ratio(prediction, reference);
  if (ratio == 0 || !is_odd_length_ratio(ratio)) return {};
  return fmt::format(
      "depth is {:.3g} times the reference's (median) and is scored as metres; is it in {}, or "
      "disparity?",
      ratio,
      likely_unit(ratio)
  );
}

std::string normal_axes_doubt(
    ImageView prediction, ImageView reference, const std::string& found_axes
) {
  constexpr double kSuspicious = 0.5;  // of the error, as `eval` has it
  // Degrees: below, one rotation fits the noise of flat pictures.
  constexpr double kLeastOfTurns = 30;
  const double given = mean_angle(prediction, reference);
  const Axes& found = axes_called(found_axes);
  for (const Axes& other : kAxes)
    if (other.name != found_axes &&
        angle_in_axes(prediction, reference, found, other) < kSuspicious * given)
      return fmt::format(
          "normals fit the reference far better as '{0}': give --axes {0}", other.name
      );
  if (given < kLeastOfTurns || angle_when_turned(prediction, reference) > kSuspicious * given)
    return {};
  return "normals fit the reference far better when all of them are turned alike: are they in the "
         "world's axes? `glint-bench eval --normal-axes world` turns them by the cameras";
}

std::string lossy_doubt(std::span<const FilePair> pairs) {
  const auto count =
      std::ranges::count_if(pairs, [](const FilePair& pair) { return is_jpeg(pair.prediction); });
  if (count == 0) return {};
  return fmt::format(
      "{} of {} predictions are JPEG, which is lossy: scores are of what the compression left",
      count,
      pairs.size()
  );
}

}  // namespace glint
