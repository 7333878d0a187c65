// SPDX-License-Identifier: MIT
// PLY as surfels, points and meshes; what was read can be written, and is then read again.
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

}  // namespace

GLINT_REGISTER(FuzzTarget, {"ply", read, seeds})

}  // namespace glint::fuzz
