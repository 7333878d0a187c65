// SPDX-License-Identifier: MIT
#include "reports/run/bench/stage_documents.h"

#include <cmath>

#include "glint/core/machine.h"
#include "glint/train/perceptual.h"
#include "metrics/fusion/tsdf_volume.h"
#include "metrics/metric.h"
#include "reports/run/bench/device_of_cells.h"
#include "reports/run/records/code_hashes.h"

namespace glint {
namespace {

constexpr const char* kMemoryLimit = "max_memory_mb";  // of TsdfOptions

bool cells_on_gpu() { return DeviceOfCells::now() != Device::kCpu; }
const char* device_kind() { return cells_on_gpu() ? "cuda" : "cpu"; }

// The code of the method (of none: renders of another program), of `stage`, and what a GPU adds.
Json code_for(const std::string& method, const std::string& stage) {
  std::vector<std::string> entries;
  if (!stage.empty()) entries.push_back(stage);
  const auto found = Registry<MethodSpec>::all().find(method);
  const std::string own =
      found == Registry<MethodSpec>::all().end() ? "" : code_entry_of(found->second.source);
  if (!own.empty()) entries.push_back(own);
  if (cells_on_gpu()) entries.push_back("cuda");
  return code_json(entries);
}

// The network of a training that looks at LPIPS.
Json perceptual_machine(const Json& config) {
  Json machine = Json::object();
  if (config.value("lambda_lpips", 0.0) <= 0) return machine;
  const std::string network = perceptual_network();
  machine["lpips"] = network.empty() ? Json("no weights") : Json{{"network", network}};
  return machine;
}

// Files of metrics: their provenance, or what is missing.
Json metric_machine() {
  Json machine = Json::object();
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics)
      if (family.files) {
        const MetricFiles files = family.files(metric);
        machine[metric.id] = files.missing.empty() ? files.provenance : Json(files.missing);
      }
  return machine;
}

// The constants of every metric, without their files.
Json metric_constants() {
  Json constants = Json::object();
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics) constants[metric.id] = metric.protocol;
  return constants;
}

}  // namespace

Json train_document(
    const std::string& method, const Json& overrides, const RunOptions& options, const Json& data
) {
  const Json config = create_method(method, overrides)->config();
  return {
      {"data", data},
      {"method", method},
      {"config", config},
      {"iterations", options.iterations},
      {"seed", options.seed},
      {"device", device_kind()},
      {"machine", perceptual_machine(config)},
      {"code", code_for(method, "")}};
}

Json render_document(const std::string& method, const std::string& train_key) {
  return {
      {"inputs", {{"train", train_key}}},
      {"device", device_kind()},
      {"code", code_for(method, "render")}};
}

Json mesh_document(
    const std::string& method, const std::string& train_key, const TsdfOptions& options
) {
  Json fields = config_to_json(options);
  fields.erase(kMemoryLimit);  // decides whether there is a mesh at all, not which
  return {
      {"inputs", {{"train", train_key}}},
      {"mesh", fields},
      {"device", device_kind()},
      {"machine", {{"Open3D", has_tsdf_volume() ? Json::object() : Json("missing")}}},
      {"code", code_for(method, "mesh")}};
}

Json document_without_mesh(Json document, const TsdfOptions& options) {
  document["mesh"][kMemoryLimit] = options.max_memory_mb;
  if (options.max_memory_mb <= 0 && has_tsdf_volume())  // whole numbers: kernels keep some MB
    document["mesh"]["machine_memory_gb"] =
        std::llround(static_cast<double>(this_machine().memory_bytes) / 1e9);
  return document;
}

Json score_document(
    const std::string& method,
    const ScoreInputs& inputs,
    const MeshProtocol& protocol,
    const std::optional<TimingOptions>& timing
) {
  Json fields = config_to_json(protocol);
  fields.erase("distance");  // both are scored
  Json document = {
      {"inputs", {{"render", inputs.render_key}, {"mesh", inputs.mesh_key}}},
      {"mesh_metrics", fields},
      {"timing_frames", timing ? Json(timing->frames) : Json()},
      {"timing_warmup", timing ? Json(timing->warmup) : Json()},
      {"metrics", metric_constants()},
      {"device", device_kind()},
      {"machine", metric_machine()},
      {"code", code_for(method, "score")}};
  if (!inputs.truth.empty()) document["truth"] = inputs.truth;
  return document;
}

}  // namespace glint
