// SPDX-License-Identifier: MIT
#include "glint/scene/gaussian_ply.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/render/activations.h"
#include "glint/scene/ply.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

// A Gaussian for each row of scales, all turned alike; the extra fields have the values 0.25, 1.25,
// 2.25, ...
void write_gaussians(
    const fs::path& path,
    const std::vector<std::vector<float>>& log_scales,
    const std::vector<std::string>& extra
) {
  std::vector<std::string> fields{
      "x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity"};
  for (std::size_t k = 0; k < log_scales[0].size(); ++k)
    fields.push_back("scale_" + std::to_string(k));
  for (int k = 0; k < 4; ++k) fields.push_back("rot_" + std::to_string(k));
  fields.insert(fields.end(), extra.begin(), extra.end());
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(log_scales.size()) + "\n";
  for (const std::string& field : fields) bytes += "property float " + field + "\n";
  bytes += "end_header\n";
  const auto put = [&](float value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const auto& scales : log_scales) {
    for (const float value : {1.f, 2.f, 3.f, 0.f, 0.f, 0.f, 0.1f, 0.2f, 0.3f, 1.5f}) put(value);
    for (const float scale : scales) put(scale);
    for (const float q : {0.9f, 0.1f, -0.3f, 0.2f}) put(q);
    for (std::size_t k = 0; k < extra.size(); ++k) put(static_cast<float>(k) + 0.25f);
  }
  write_file(path, bytes);
}

Mat3d rotation_of(const float* q) { return rotation_matrix(Vec4<double>{q[0], q[1], q[2], q[3]}); }

}  // namespace

TEST_CASE("an ellipsoid loses its smallest axis, whichever it is") {
  const TempFolder folder;
  const fs::path path = folder / "point_cloud.ply";
  const float scales[3] = {std::log(0.3f), std::log(0.2f), std::log(0.001f)};
  // The same ellipsoid's axes in three orders: what stays are the other two and their directions.
  for (int smallest = 0; smallest < 3; ++smallest) {
    std::vector<float> row(3);
    const int first = (smallest + 1) % 3, second = (smallest + 2) % 3;
    row[static_cast<std::size_t>(smallest)] = scales[2];
    row[static_cast<std::size_t>(first)] = scales[0];
    row[static_cast<std::size_t>(second)] = scales[1];
    write_gaussians(path, {row, {-1.0f, -2.0f, -3.0f}}, {});
    std::vector<std::string> ignored;
    const GaussianPly read = read_gaussian_ply(path, {}, ignored);
    CHECK(read.has_ellipsoids);
    CHECK(read.cloud.log_scales[0] == scales[0]);
    CHECK(read.cloud.log_scales[1] == scales[1]);
    const float q[4] = {0.9f, 0.1f, -0.3f, 0.2f};
    const Mat3d before = rotation_of(q), after = rotation_of(&read.cloud.rotations[0]);
    const auto same = [](Vec3d a, Vec3d b) { return length(a - b) < 1e-6; };
    CHECK(same(column(after, 0), column(before, first)));
    CHECK(same(column(after, 1), column(before, second)));
    CHECK(same(column(after, 2), column(before, smallest)));
  }
}

TEST_CASE("how flat ellipsoids are is told") {
  const TempFolder folder;
  const fs::path path = folder / "a.ply";
  std::vector<std::vector<float>> rows;
  for (int i = 0; i < 11; ++i)
    rows.push_back({std::log(0.1f * static_cast<float>(i + 1)), 0.5f, 1.0f + static_cast<float>(i)}
    );
  std::vector<std::string> ignored;
  write_gaussians(path, rows, {});
  const Flatness flatness = read_gaussian_ply(path, {}, ignored).flatness;
  // 0.1 ... 1.1 over e^0.5.
  CHECK(flatness.median == Approx(0.6 / std::exp(0.5)).epsilon(1e-5));
  CHECK(flatness.percentile_90 == Approx(1.0 / std::exp(0.5)).epsilon(1e-5));
}

TEST_CASE("surfels stay as they are, ours and those of two scales") {
  const TempFolder folder;
  std::vector<std::string> ignored;
  write_gaussians(folder / "2dgs.ply", {{-9.0f, -2.0f}, {-1.0f, -3.0f}}, {});
  const GaussianPly two = read_gaussian_ply(folder / "2dgs.ply", {}, ignored);
  CHECK_FALSE(two.has_ellipsoids);
  CHECK(two.cloud.log_scales[0] == -9.0f);
  // A third scale that is the same everywhere is for viewers, also where a surfel is smaller still.
  write_gaussians(folder / "ours.ply", {{-20.0f, -2.0f, -13.8f}, {-1.0f, -3.0f, -13.8f}}, {});
  const GaussianPly ours = read_gaussian_ply(folder / "ours.ply", {}, ignored);
  CHECK_FALSE(ours.has_ellipsoids);
  CHECK(ours.cloud.log_scales[0] == -20.0f);
  CHECK(ours.cloud.rotations[0] == 0.9f);
}

TEST_CASE("channels are found under the names of others, in the order that is asked for") {
  const TempFolder folder;
  const fs::path path = folder / "pcd.ply";
  write_gaussians(path, {{-1, -2}}, {"roughness", "specular_0", "transmission_coeff"});
  std::vector<std::string> ignored;
  const SurfelCloud cloud = read_gaussian_ply(path, {"transparency", "specular"}, ignored).cloud;
  CHECK(cloud.extra_names == std::vector<std::string>{"transparency", "specular"});
  CHECK(cloud.extra_logits[0] == 2.25f);
  CHECK(cloud.extra_logits[1] == 1.25f);
  CHECK(ignored == std::vector<std::string>{"roughness"});
  ignored.clear();
  CHECK(read_gaussian_ply(path, {}, ignored).cloud.num_extra() == 0);
  CHECK(ignored.size() == 3);
}

TEST_CASE("what is no Gaussian is refused, with a way out") {
  const TempFolder folder;
  std::vector<std::string> ignored;
  const auto message = [&](const fs::path& path, const std::vector<std::string>& wanted) {
    return bad_reference([&] { read_gaussian_ply(path, wanted, ignored); });
  };
  PointCloud points;
  points.positions = {{0, 0, 0}};
  points.colors = {{1, 1, 1}};
  write_point_ply(folder / "points.ply", points);
  CHECK_THAT(message(folder / "points.ply", {}), Contains("no scale_0 and scale_1"));
  write_file(
      folder / "packed.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty uint packed_position\nend_header\n5\n"
  );
  CHECK_THAT(message(folder / "packed.ply", {}), Contains("SuperSplat"));
  write_gaussians(folder / "base.ply", {{-1, -2}}, {});
  CHECK_THAT(message(folder / "base.ply", {"specular"}), Contains("no field specular"));
  write_gaussians(folder / "nan.ply", {{-1, -2, std::nanf("")}}, {});
  CHECK_THAT(message(folder / "nan.ply", {}), Contains("scale_2"));
}
