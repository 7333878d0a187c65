// SPDX-License-Identifier: MIT
// Cells without a mesh, or without the cost of their training: what is recorded, and when it is
// tried again.
#include "reports/run/bench/cell_run.h"

#include <catch2/catch.hpp>

#include <algorithm>

#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "metrics/fusion/tsdf_volume.h"
#include "metrics/metric.h"
#include "reports/run/bench/mesh_stage.h"
#include "reports/run/bench/stages.h"
#include "tests/metrics/mesh/shapes.h"
#include "tests/reports/run/bench/one_cell.h"

using namespace glint;
using test::OneCell;

namespace {

[[maybe_unused]] const bool quiet = (set_quiet(true), true);

#define SKIP_WITHOUT_OPEN3D()                              \
  if (!has_tsdf_volume()) {                                \
    WARN("skipped: built without Open3D (libopen3d-dev)"); \
    return;                                                \
  }

// Where the fake method renders its surface: 2 m in front of the cameras.
TriangleMesh wall() { return test::parallelogram({-4, -4, 2}, {8, 0, 0}, {0, 8, 0}, 8, 8); }

// Data with true meshes, which are compared at few points.
struct TrueMeshes : test::TempFolder {
  TrueMeshes() {
    for (const MeshLayer& layer : kMeshLayers) write_mesh_ply(path() / layer.truth, wall());
  }
  void add_to(RunnerOptions& options) const {
    options.profile.mesh_metrics = {{"num_samples", 1000}, {"cull", "none"}};
    options.load = [data = path()](const SceneSource& source) {
      return LoadedScene{fake_scene(source.scene), data};
    };
  }
};

bool has_mesh_values(const std::map<std::string, double>& metrics) {
  const auto& list = mesh_metric_list();
  return std::any_of(list.begin(), list.end(), [&](const Metric& metric) {
    return metrics.contains(metric.id);
  });
}

void check_no_mesh(const OneCell& cell, const std::string& why) {
  const Record record = cell.record();
  REQUIRE(record.ok());
  CHECK_FALSE(has_mesh_values(record.metrics));
  for (const char* id : {"mesh-cd", "behind-mesh-cd"}) {
    REQUIRE(record.not_measured.contains(id));
    CHECK_THAT(record.not_measured.at(id), Catch::StartsWith(why));
  }
  for (const char* left : {"mesh.ply", "mesh_transmission.ply", "mesh.json", "renders_train"})
    CHECK_FALSE(fs::exists(cell.run / left));
  CHECK(read_stage(cell.run, Stage::kMesh)->files.empty());
}

// The training's stage as earlier versions left it.
void forget_cost(const OneCell& cell) {
  const Json document = read_stage(cell.run, Stage::kTrain)->document;
  write_stage(cell.run, Stage::kTrain, document, {"interface.ply"});
  fs::remove(cell.run / "env.json");
}

}  // namespace

TEST_CASE("both layers of a cell are fused and scored") {
  SKIP_WITHOUT_OPEN3D();
  const TrueMeshes data;
  const OneCell cell([&](RunnerOptions& options) { data.add_to(options); });
  CHECK(fs::exists(cell.run / "mesh.ply"));
  const auto metrics = cell.record().metrics;
  REQUIRE(metrics.contains("mesh-cd"));
  CHECK(metrics.at("behind-mesh-cd") == metrics.at("mesh-cd"));  // one layer serves for both
}

TEST_CASE("a second layer that cannot be fused leaves no mesh of the first, and no score") {
  SKIP_WITHOUT_OPEN3D();
  const TrueMeshes data;
  const OneCell cell([&](RunnerOptions& options) {
    data.add_to(options);
    options.assignments = {"fails=behind"};
  });
  check_no_mesh(cell, "no mesh: no depth to fuse");
}

TEST_CASE("a mesh that lies beside a note of the stage is not scored") {
  const TrueMeshes data;
  const OneCell cell([&](RunnerOptions& options) { data.add_to(options); });
  write_mesh_ply(cell.run / "mesh.ply", wall());
  const auto scored = [&](const std::string& note) {
    const Json document = read_stage(cell.run, Stage::kMesh)->document;
    write_stage(cell.run, Stage::kMesh, document, {"mesh.ply"}, note);
    RunSpec spec = read_run_spec(cell.run);
    MeshProtocol protocol;
    protocol.num_samples = 1000;
    return has_mesh_values(eval_stage(spec, fake_scene("room_1"), {.mesh = protocol}));
  };
  CHECK(scored(""));
  CHECK_FALSE(scored("no mesh: no depth to fuse"));
}

TEST_CASE("the mesh of the first surface stands in where a method does not look behind glass") {
  const test::TempFolder run;
  write_mesh_ply(run / "mesh.ply", wall());
  const fs::path behind = run / "mesh_transmission.ply";
  const MeshLayer& layer = kMeshLayers[1];
  CHECK(mesh_of(run.path(), layer) == run / "mesh.ply");
  write_exr(run / "renders/0002/transparency.exr", Image(4, 3, 1));
  CHECK(mesh_of(run.path(), layer) == run / "mesh.ply");
  write_exr(run / "renders/0002/behind_depth.exr", Image(4, 3, 1));
  CHECK(mesh_of(run.path(), layer) == behind);
  CHECK(mesh_of(run.path(), kMeshLayers[0]) == run / "mesh.ply");
}

TEST_CASE("a mesh that did not fit is made when more memory is allowed, and not before") {
  SKIP_WITHOUT_OPEN3D();
  OneCell cell([](RunnerOptions& options) { options.profile.mesh["max_memory_mb"] = 0.5; });
  check_no_mesh(cell, "no mesh: voxels of 0.01 m need");
  CHECK(cell.stages().why() == "");
  CHECK(cell.run_again(0) == "");
  cell.options.profile.mesh["max_memory_mb"] = 4000;
  CHECK_THAT(
      cell.stages().why(), Catch::StartsWith("mesh: mesh.max_memory_mb 0.5 -> 4000; score: after")
  );
  CHECK(cell.run_again(0) == "mesh score");
  CHECK(fs::exists(cell.run / "mesh.ply"));
  CHECK_FALSE(cell.record().not_measured.contains("mesh-cd"));
  // One that fits is the same whatever is allowed.
  cell.options.profile.mesh["max_memory_mb"] = 3000;
  CHECK(cell.run_again(0) == "");
}

TEST_CASE("a cell without a mesh that is trained again has the keys of what came of it") {
  SKIP_WITHOUT_OPEN3D();
  OneCell cell([](RunnerOptions& options) { options.profile.mesh["max_memory_mb"] = 0.5; });
  fs::remove(cell.run / "interface.ply");
  CHECK(cell.run_again(1) == "train render mesh score");
  fs::remove(cell.run / "interface.ply");
  cell.options.profile.mesh["max_memory_mb"] = 4000;
  CHECK(cell.run_again(1) == "train render mesh score");
  CHECK(fs::exists(cell.run / "mesh.ply"));
}

TEST_CASE("what training took is one of its files: without it, the cell is trained again") {
  OneCell cell;
  CHECK(read_stage(cell.run, Stage::kTrain)->files.contains("env.json"));
  CHECK(cell.record().metrics.at("train-minutes") > 0);
  CHECK_FALSE(cell.record().metrics.contains("device-memory"));  // trained on the CPU
  CHECK(cell.record().void_steps == Json({{"count", 0}, {"last", -1}}));
  fs::remove(cell.run / "env.json");
  CHECK(cell.stages()[Stage::kTrain].why == "env.json is missing");
  CHECK(cell.run_again(1) == "train render mesh score");
}

TEST_CASE("a training of an earlier version whose cost is gone has none, which is not zero") {
  OneCell cell;
  forget_cost(cell);
  cell.options.profile.timing_frames += 1;
  CHECK(cell.run_again(0) == "score");
  const Record record = cell.record();
  REQUIRE(record.ok());
  for (const char* id : {"train-minutes", "peak-memory"}) {
    CHECK_FALSE(record.metrics.contains(id));
    REQUIRE(record.not_measured.contains(id));
    CHECK(record.not_measured.at(id) == "no env.json");
  }
  CHECK_FALSE(record.timings.contains("train"));
  CHECK(record.num_surfels == 7);
}
