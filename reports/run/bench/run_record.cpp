// SPDX-License-Identifier: MIT
#include "reports/run/bench/run_record.h"

#include "glint/core/presence.h"
#include "metrics/metric.h"
#include "reports/run/bench/mesh_stage.h"
#include "reports/run/records/environment.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

// Cost that is not known has no value: a zero would be the best of a table.
void add_unmeasured(Record& record, const RunSpec& spec, const std::optional<TrainCost>& cost) {
  record.not_measured = missing_metrics();
  if (const auto mesh = read_stage(spec.folder, Stage::kMesh); mesh && !mesh->note.empty())
    for (const Metric& metric : mesh_metric_list()) record.not_measured[metric.id] = mesh->note;
  if (!cost && read_stage(spec.folder, Stage::kTrain))
    for (const char* id : {"train-minutes", "peak-memory"}) record.not_measured[id] = "no env.json";
  if (!record.metrics.contains("psnr") && record.metrics.contains("psnr-8bit"))
    record.not_measured["psnr"] = "8-bit images";
}

void add_training(Record& record, const TrainCost& cost) {
  if (cost.seconds > 0) record.timings["train"] = cost.seconds;
  record.warnings = cost.warnings;
  record.notes = cost.notes;
  record.data_notes = cost.data_notes;
  record.void_steps = cost.void_steps;
}

// What is neither measured nor unmeasured for a reason: views without a truth of the kind, surfaces
// without a true mesh.
std::vector<std::string> without_truth(const Record& record, const RunSpec& spec) {
  std::vector<std::string> ids = not_applicable(record.metrics, record.not_measured);
  for (std::string& id : meshes_without_truth(record, spec)) ids.push_back(std::move(id));
  return ids;
}

}  // namespace

RunSpec make_spec(
    const PlanCell& cell, const Profile& profile, const LoadedScene& loaded, const fs::path& run
) {
  RunSpec spec;
  spec.folder = run;
  spec.method = cell.cell.method;
  spec.config = cell.config;
  spec.options = {.iterations = profile.iterations, .seed = cell.cell.seed};
  spec.dataset_folder = loaded.folder;
  spec.dataset = cell.source.dataset;
  spec.scene = cell.cell.scene;
  spec.max_pixels = cell.source.max_pixels;
  spec.image_ratio = cell.source.image_ratio;
  spec.dataset_hash = loaded.scene.spec_hash;
  spec.test_psnr_every = profile.test_psnr_every;
  return spec;
}

Record new_record(const std::string& profile, const std::string& dataset, const CellKey& cell) {
  Record record;
  record.profile = profile;
  record.dataset = dataset;
  record.cell = cell;
  record.environment = environment_json();
  return record;
}

std::vector<std::string> meshes_without_truth(const Record& record, const RunSpec& spec) {
  std::vector<std::string> ids;
  for (const MeshLayer& layer : kMeshLayers) {
    if (is_there(true_mesh(spec.dataset_folder, layer.truth))) continue;
    for (const Metric& metric : mesh_metric_list()) {
      const bool behind = metric.id.starts_with(kBehindMesh);
      if (behind == (std::string_view(layer.prefix) == kBehindMesh) &&
          !record.metrics.contains(metric.id) && !record.not_measured.contains(metric.id))
        ids.push_back(metric.id);
    }
  }
  return ids;
}

Scores training_cost(const RunSpec& spec) {
  const auto cost = trained_cost(spec);
  if (!cost || cost->seconds <= 0) return {};
  Scores scores = {{"train-minutes", cost->seconds / 60}, {"peak-memory", cost->peak_memory_mb}};
  if (cost->device_memory_mb > 0) scores["device-memory"] = cost->device_memory_mb;
  return scores;
}

Record make_record(
    const std::string& profile, const RunSpec& spec, const Scene& scene, const Scores& means
) {
  Record record = new_record(profile, spec.dataset, spec.cell());
  record.metrics = means;
  record.train_key = key_of_stage(spec.folder, Stage::kTrain);
  record.score_key = key_of_stage(spec.folder, Stage::kScore);
  record.dataset_hash = scene.spec_hash;
  record.iterations = spec.options.iterations;
  if (record.iterations > 0) record.training_views = static_cast<int>(scene.train.size());
  const std::optional<TrainCost> cost = trained_cost(spec);
  add_unmeasured(record, spec, cost);
  record.not_applicable = without_truth(record, spec);
  if (cost) add_training(record, *cost);
  if (const auto surfels = means.find("num-surfels"); surfels != means.end())
    record.num_surfels = static_cast<std::size_t>(surfels->second);
  const Camera& camera = scene.test.front().camera;
  record.resolution = fmt::format("{}x{}", camera.width, camera.height);
  return record;
}

}  // namespace glint
