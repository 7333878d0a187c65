// SPDX-License-Identifier: MIT
#include <memory>

#include "reports/mesh/tsdf.h"
#include "reports/verbs/single_run.h"

namespace glint {

namespace {

// What an earlier scoring of the run found out about its cost; scoring again does not change it.
std::map<std::string, double> earlier_cost(const RunSpec& spec) {
  std::map<std::string, double> cost;
  if (const auto trained = trained_cost(spec)) {
    cost["train-minutes"] = trained->seconds / 60;
    cost["peak-memory"] = trained->peak_memory_mb;
  }
  const fs::path path = spec.folder / "metrics.json";
  if (!fs::exists(path)) return cost;
  const Json json = Json::parse(read_file(path), nullptr, false);
  if (json.is_object() && json.contains("metrics"))
    for (const char* id : {"fps", "num-surfels"})
      if (const auto it = json["metrics"].find(id); it != json["metrics"].end() && it->is_number())
        cost[id] = it->get<double>();
  return cost;
}

// That of the voxels the run's meshes were made with.
MeshProtocol mesh_protocol_of(const RunSpec& spec) {
  const fs::path path = spec.folder / "mesh.json";
  if (!fs::exists(path)) return {};
  const Json json = Json::parse(read_file(path), nullptr, false);
  GLINT_CHECK(
      json.is_object() && json.contains("options"),
      kBadPrediction,
      "{}: not a report of the mesh stage; run `glint-bench mesh` again",
      path.string()
  );
  TsdfOptions options;
  config_from_json(options, json["options"], path.string());
  return mesh_protocol_for(options);
}

int run_eval(const CommonOptions& common, const std::string& folder) {
  const SingleRun single = open_single_run(folder);
  const auto means = eval_stage(
      single.spec, single.scene, earlier_cost(single.spec), mesh_protocol_of(single.spec)
  );
  if (common.json) {
    print_json({{"run", folder}, {"metrics", means}});
    return 0;
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [id, value] : means) rows.push_back({id, fmt::format("{:.4f}", value)});
  print_text(aligned_rows(rows));
  return 0;
}

}  // namespace

void add_eval_verb(CommandLine& line) {
  auto folder = std::make_shared<std::string>();
  line.add_verb(
          line.app,
          "eval",
          "score the renders of a run; writes metrics.json",
          [&line, folder] { return run_eval(line.common, *folder); }
  )
      ->add_option("--run", *folder, "run folder")
      ->required();
}

}  // namespace glint
