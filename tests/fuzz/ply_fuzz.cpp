// SPDX-License-Identifier: MIT
// PLY as surfels, points and meshes; what was read can be written, and is then read again. And
// Gaussians of other programs, with and without a channel that is asked for.
#include <cmath>

#include "glint/scene/gaussian_ply.h"
#include "glint/scene/ply.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

void check_again(bool good, const char* what) {
  if (!good) throw Finding(fmt::format("{}: written again, it is not what was read", what));
}

bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.ply"), again = input_folder() / "again.ply";
  accepts([&] { is_mesh_ply(file); });
  const bool surfels = accepts([&] {
    const SurfelCloud cloud = read_surfel_ply(file);
    if (cloud.num_extra() > 0) return;  // their names may be no words
    write_surfel_ply(again, cloud);
    check_again(read_surfel_ply(again).size() == cloud.size(), "surfels");
  });
  const bool points = accepts([&] {
    const PointCloud cloud = read_point_ply(file);
    write_point_ply(again, cloud);
    check_again(read_point_ply(again).positions.size() == cloud.positions.size(), "points");
  });
  const bool mesh = accepts([&] {
    const TriangleMesh mesh = read_mesh_ply(file, NonFinite::kKeep);
    write_mesh_ply(again, mesh);
    check_again(read_mesh_ply(again, NonFinite::kKeep).faces == mesh.faces, "mesh");
  });
  return surfels || points || mesh;
}

SurfelCloud one_surfel() {
  SurfelCloud cloud;
  cloud.extra_names = {"transparency"};
  cloud.resize(1);
  cloud.rotations[0] = 1;
  return cloud;
}

std::vector<FuzzInput> seeds() {
  const PointCloud points{{{0, 1, 2}, {3, 4, 5}}, {{0, 1, 0}, {1, 1, 0}}, {{0, 0, 1}, {0, 1, 0}}};
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 1, 2}};
  return {
      written("surfel", [](const fs::path& p) { write_surfel_ply(p, one_surfel()); }),
      written("points", [&](const fs::path& p) { write_point_ply(p, points); }),
      written("mesh", [&](const fs::path& p) { write_mesh_ply(p, mesh); }),
      {"polygon_ascii",
       "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty double x\n"
       "property double y\nproperty double z\nproperty ushort red\nproperty ushort green\n"
       "property ushort blue\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
       "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 65535 0 0\n4 0 1 2 3\n"}};
}

void check_surfels(const GaussianPly& found, std::size_t channels) {
  const SurfelCloud& cloud = found.cloud;
  if (cloud.num_extra() != channels) throw Finding("channels that nobody asked for");
  for (const float q : cloud.rotations)
    if (!std::isfinite(q)) throw Finding("a rotation that is not finite");
  for (const float scale : cloud.log_scales)
    if (!std::isfinite(scale)) throw Finding("a scale that is not finite");
}

bool read_gaussians(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.ply"), again = input_folder() / "again.ply";
  accepts([&] {
    std::vector<std::string> ignored;
    check_surfels(read_gaussian_ply(file, {"transparency"}, ignored), 1);
  });
  return accepts([&] {
    std::vector<std::string> ignored;
    const GaussianPly found = read_gaussian_ply(file, {}, ignored);
    check_surfels(found, 0);
    write_surfel_ply(again, found.cloud);
    if (read_surfel_ply(again).size() != found.cloud.size())
      throw Finding("surfels that are others when they are written again");
  });
}

// Two Gaussians of degree 0 with these scales and further fields, as text.
std::string text_ply(const std::string& fields, const std::string& values) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 2\n";
  for (const char* name :
       {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "rot_0", "rot_1", "rot_2", "rot_3"})
    text += fmt::format("property float {}\n", name);
  text += fields + "end_header\n";
  for (const char* place : {"0 0 2", "0.5 0 2"})
    text += fmt::format("{} 0.1 0.2 0.3 1 1 0 0 0 {}\n", place, values);
  return text;
}

std::vector<FuzzInput> gaussian_seeds() {
  const std::string two = "property float scale_0\nproperty float scale_1\n";
  std::string ellipsoids = text_ply(two + "property float scale_2\n", "-3 -9 -4");
  ellipsoids.replace(ellipsoids.rfind("-4"), 2, "-5");
  return {
      {"surfels", text_ply(two, "-3 -4")},
      {"ellipsoids", ellipsoids},
      {"official", text_ply(two + "property float transmission_coeff\n", "-3 -4 0.5")}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"ply", read, seeds})
GLINT_REGISTER(FuzzTarget, {"gaussian_ply", read_gaussians, gaussian_seeds})

}  // namespace glint::fuzz
