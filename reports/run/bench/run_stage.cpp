// SPDX-License-Identifier: MIT
#include "reports/run/bench/run_stage.h"

#include "glint/core/left_behind.h"

namespace glint {

std::vector<std::string> stage_outputs(Stage stage) {
  if (stage == Stage::kRender) return {"renders", "strip.png"};
  if (stage == Stage::kMesh) return {"mesh.ply", "mesh_transmission.ply", "mesh.json"};
  if (stage == Stage::kScore) return {"metrics.json"};
  return {};
}

void begin_stage(const fs::path& run, Stage stage) {
  remove_left_behind(run);
  for (const Stage undone : {stage, Stage::kScore}) forget_stage(run, undone);
}

void end_stage(const fs::path& run, Stage stage, const Json& document, const std::string& note) {
  write_stage(run, stage, document, stage_outputs(stage), note);
}

StageFile finished_stage(const fs::path& run, Stage stage, std::string_view verb) {
  const auto found = read_stage(run, stage);
  GLINT_CHECK(
      found.has_value(),
      kBadPrediction,
      "{}: no keys/{}.json: the stage has not ended here, or an earlier version ran it; run "
      "`glint-bench {}` first",
      run.string(),
      stage_name(stage),
      verb
  );
  return *found;
}

}  // namespace glint
