// SPDX-License-Identifier: MIT
// Of every registered method: what is left of its model renders the depth of its training views.
#include "reports/run/parcels/compact_model.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "datasets/dataset.h"
#include "glint/core/evenly_chosen.h"
#include "reports/run/bench/stage_documents.h"
#include "reports/run/bench/stages.h"
#include "reports/run/parcels/model_files.h"
#include "reports/run/records/stage_files.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

// Trained for so many steps in the small room.
RunSpec trained(const std::string& method, int iterations, const fs::path& folder) {
  RunSpec spec;
  spec.folder = folder;
  spec.method = method;
  spec.options.iterations = iterations;
  spec.dataset_folder = small_room_folder();
  spec.scene = "room_1";
  spec.train_document = train_document(method, spec.config, spec.options, Json::object());
  train_stage(spec, small_room());
  return spec;
}

// Loaded from what is left, and compared once more.
DepthDifference difference_of(const RunSpec& spec, const CompactModel& model) {
  const TempFolder folder;
  for (const CompactFile& file : model.files) write_compact_file(file, folder.path());
  const auto whole = load_trained(spec), compact = create_method(spec.method, spec.config);
  compact->load(folder.path().string());
  const Scene& scene = small_room();
  const auto views = evenly_chosen(scene.train.size(), scene.train.size());
  return depth_difference(fused_depths(*whole, scene, views), fused_depths(*compact, scene, views));
}

std::size_t packed_bytes(const CompactModel& model) {
  std::size_t bytes = 0;
  for (const CompactFile& file : model.files) bytes += file.code.num_bytes();
  return bytes;
}

std::size_t packed_surfels(const CompactModel& model) {
  std::size_t count = 0;
  for (const CompactFile& file : model.files) count += file.empty ? 0 : file.code.order.size();
  return count;
}

const CompactFile& file_of(const CompactModel& model, const std::string& name) {
  for (const CompactFile& file : model.files)
    if (file.name == name) return file;
  FAIL("no file " << name);
  return model.files.front();
}

}  // namespace

TEST_CASE("what is left of every method's model renders its depth within the limit") {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    const TempFolder folder;
    const RunSpec run = trained(id, 20, folder / "run");
    const CompactModel model = compact_model(run, small_room());
    CHECK(model.tolerance > 0);
    CHECK(model.difference.mean <= kDepthLimit);
    CHECK(model.difference.one_sided <= kOneSidedLimit);
    CHECK(difference_of(run, model) == model.difference);
    CHECK(packed_bytes(model) < 16 * packed_surfels(model));
  }
}

TEST_CASE("sets, channels and arrays that depth does not depend on are left out") {
  const TempFolder folder;
  const CompactModel glint = compact_model(trained("glint", 300, folder / "glint"), small_room());
  CHECK(!file_of(glint, "interface.ply").empty);
  CHECK(!file_of(glint, "transmission.ply").empty);
  CHECK(file_of(glint, "reflection.ply").empty);
  CHECK(file_of(glint, "interface.ply").code.about["kept"] == Json({"transparency"}));
  const CompactModel ref = compact_model(trained("ref-gs", 60, folder / "ref-gs"), small_room());
  CHECK(file_of(ref, "interface.ply").code.about["kept"].empty());
  CHECK(file_of(ref, "specular_field.safetensors").zeroed);
}

TEST_CASE("a limit that no grid keeps leaves floats as they are") {
  const TempFolder folder;
  const RunSpec run = trained("2dgs", 20, folder / "run");
  const CompactModel model = compact_model(run, small_room(), 0);
  CHECK(model.tolerance == 0);
  CHECK(model.difference == DepthDifference{});
}

// Sizes and errors at several tolerances, of a run that GLINT_TEST_RUN names.
TEST_CASE("sizes of packed surfels", "[.sizes]") {
  const char* folder = std::getenv("GLINT_TEST_RUN");
  REQUIRE(folder != nullptr);
  const RunSpec spec = read_run_spec(folder);
  const Scene scene = load_scene(spec.dataset_folder, {});
  for (const double limit : {5e-5, 1e-4, 2e-4}) {
    const CompactModel model = compact_model(spec, scene, limit);
    fmt::print(
        "limit {:g} mm: tolerance {:g} mm, error {:.4f} mm, one-sided {:.2e}\n",
        1e3 * limit,
        1e3 * model.tolerance,
        1e3 * model.difference.mean,
        model.difference.one_sided
    );
    for (const CompactFile& file : model.files) {
      if (!file.surfels || file.empty) continue;
      const auto kept = static_cast<double>(file.code.order.size());
      fmt::print(
          "  {}: {} of {} surfels, {} bytes, {:.2f} a surfel:",
          file.name,
          file.code.order.size(),
          file.count,
          file.code.num_bytes(),
          static_cast<double>(file.code.num_bytes()) / kept
      );
      for (const auto& [name, bytes] : file.code.fields)
        fmt::print(" {} {:.2f}", name, 8 * static_cast<double>(bytes.size()) / kept);
      fmt::print(" bits\n");
    }
  }
}
