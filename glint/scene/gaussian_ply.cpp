// SPDX-License-Identifier: MIT
#include "glint/scene/gaussian_ply.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "glint/core/error.h"
#include "glint/scene/ply.h"
#include "glint/scene/ply_reader.h"

namespace glint {
namespace {

// A channel's name here and in the files of others; "" ends the list.
constexpr std::array<std::array<std::string_view, 4>, 2> kAliases{{
    {"transparency", "transmission_coeff", "transmission_coeff_0", "transparency_0"},
    {"specular", "specular_0", "specularity", "specularity_0"},
}};

bool is_called(const std::string& field, const std::string& channel) {
  if (field == channel) return true;
  for (const auto& names : kAliases)
    if (names[0] == channel) return std::find(names.begin(), names.end(), field) != names.end();
  return false;
}

void check_fields(const detail::PlyFile& file) {
  const detail::PlyElement& vertices = file.element("vertex");
  GLINT_CHECK(
      vertices.find_scalar("packed_position") < 0,
      kBadReference,
      "{}: a compressed file of SuperSplat; export it there as an uncompressed PLY",
      file.path
  );
  GLINT_CHECK(
      vertices.find_scalar("scale_1") >= 0,
      kBadReference,
      "{}: no scale_0 and scale_1; expected Gaussians with two or three scales (x, y, z, f_dc_*, "
      "opacity, scale_*, rot_*)",
      file.path
  );
}

// scale_2 of every row; empty: the file has none, or the same everywhere, as programs write it that
// have surfels and want viewers of ellipsoids to show them.
std::vector<float> third_log_scales(const detail::PlyFile& file) {
  const detail::PlyElement& vertices = file.element("vertex");
  const int column = vertices.find_scalar("scale_2");
  if (column < 0) return {};
  std::vector<float> scales(vertices.count);
  for (std::size_t i = 0; i < scales.size(); ++i) {
    scales[i] = vertices.scalar(i, column);
    GLINT_CHECK(
        std::isfinite(scales[i]),
        kBadReference,
        "{}: surfel {}: scale_2 is {}",
        file.path,
        i,
        scales[i]
    );
  }
  const bool is_constant = std::all_of(scales.begin(), scales.end(), [&](float scale) {
    return scale == scales.front();
  });
  return is_constant ? std::vector<float>{} : scales;
}

// q then p, quaternions w x y z.
void multiply(float* q, const std::array<float, 4>& p) {
  const float w = q[0], x = q[1], y = q[2], z = q[3];
  q[0] = w * p[0] - x * p[1] - y * p[2] - z * p[3];
  q[1] = w * p[1] + x * p[0] + y * p[3] - z * p[2];
  q[2] = w * p[2] - x * p[3] + y * p[0] + z * p[1];
  q[3] = w * p[3] + x * p[2] - y * p[1] + z * p[0];
}

// Turns the smallest axis of an ellipsoid into the third, which a surfel has not: axes (0, 1, 2)
// become (1, 2, 0) or (2, 0, 1), a rotation by 120 degrees about (1, 1, 1) in its own frame.
// Returns the smallest over the middle scale.
float flatten(float third, float* log_scales, float* rotation) {
  std::array<float, 3> scales{log_scales[0], log_scales[1], third};
  const auto smallest = std::min_element(scales.begin(), scales.end()) - scales.begin();
  if (smallest == 0) multiply(rotation, {0.5f, 0.5f, 0.5f, 0.5f});
  if (smallest == 1) multiply(rotation, {0.5f, -0.5f, -0.5f, -0.5f});
  std::rotate(scales.begin(), scales.begin() + (smallest + 1) % 3, scales.end());
  log_scales[0] = scales[0];
  log_scales[1] = scales[1];
  return std::exp(scales[2] - std::min(scales[0], scales[1]));
}

Flatness flatten_all(const std::vector<float>& third, SurfelCloud& cloud) {
  std::vector<float> ratios(third.size());
  for (std::size_t i = 0; i < third.size(); ++i)
    ratios[i] = flatten(third[i], &cloud.log_scales[2 * i], &cloud.rotations[4 * i]);
  const auto quantile = [&](double share) {
    if (ratios.empty()) return 0.0f;
    const auto at = ratios.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(ratios.size() - 1));
    std::nth_element(ratios.begin(), at, ratios.end());
    return *at;
  };
  return {quantile(0.5), quantile(0.9)};
}

// The cloud with the wanted channels alone.
void select_channels(
    const std::string& file,
    const std::vector<std::string>& wanted,
    std::vector<std::string>& ignored,
    SurfelCloud& cloud
) {
  const std::vector<std::string> fields = std::move(cloud.extra_names);
  const FloatArray values = std::move(cloud.extra_logits);
  std::vector<std::size_t> columns;
  for (const std::string& channel : wanted) {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const std::string& field) {
      return is_called(field, channel);
    });
    GLINT_CHECK(
        found != fields.end(),
        kBadReference,
        "{}: no field {}; it needs one beside the Gaussians' own (raw, before the sigmoid)",
        file,
        channel
    );
    columns.push_back(static_cast<std::size_t>(found - fields.begin()));
  }
  for (std::size_t k = 0; k < fields.size(); ++k)
    if (std::find(columns.begin(), columns.end(), k) == columns.end()) ignored.push_back(fields[k]);
  cloud.extra_names = wanted;
  cloud.extra_logits = FloatArray(cloud.size() * wanted.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (std::size_t k = 0; k < columns.size(); ++k)
      cloud.extra_logits[i * columns.size() + k] = values[i * fields.size() + columns[k]];
}

}  // namespace

GaussianPly read_gaussian_ply(
    const fs::path& path, const std::vector<std::string>& wanted, std::vector<std::string>& ignored
) {
  const detail::PlyFile file = detail::read_ply(path);
  check_fields(file);
  GaussianPly read;
  read.cloud = read_surfel_ply(path);
  select_channels(path.string(), wanted, ignored, read.cloud);
  const std::vector<float> third = third_log_scales(file);
  read.has_ellipsoids = !third.empty();
  if (read.has_ellipsoids) read.flatness = flatten_all(third, read.cloud);
  return read;
}

}  // namespace glint
