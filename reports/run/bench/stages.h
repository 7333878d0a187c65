// SPDX-License-Identifier: MIT
// The stages of a run: train -> render -> (mesh_stage.h) -> score. Each reads what the one before
// left in the run folder, and leaves its key there last (stage_files.h).
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "metrics/mesh/mesh_protocol.h"
#include "reports/run/bench/evaluate.h"
#include "reports/run/records/run_folder.h"

namespace glint {

struct TimingOptions {
  int frames = 50, warmup = 5;
};

// Looks at a training after each step (TrainOptions::after_step).
using AfterStep = std::function<void(Method&, const StepStats&)>;

// Trains into spec.folder, from scratch or from where an earlier training of the same document was
// stopped: config.json, log.jsonl, checkpoints, the method's files, then env.json with seconds and
// peak memory. Errors: trainer.h's; clear_run_folder()'s.
std::unique_ptr<Method> train_stage(
    const RunSpec& spec, const Scene& scene, const AfterStep& after_step = {}
);

// The trained method of a run folder. Errors (kBadPrediction): not trained, files damaged.
std::unique_ptr<Method> load_trained(const RunSpec& spec);

// Renders the test views into renders/, and strips of them for people (strip.h).
void render_stage(const RunSpec& spec, const Scene& scene, Method& method);

// Frames a second over the test cameras: the inverse of the mean frame time. Nothing is written or
// converted inside the clock.
double measure_fps(Method& method, const Scene& scene, const TimingOptions& options);

// What the files of a run score: renders/ against the scene's test views, the run's meshes against
// the dataset's. `scored` is told each view.
struct RunScores {
  std::vector<Scores> views;     // in the order of the test views
  Scores means;                  // with the values of meshes
  Json meshes = Json::object();  // their recipe; empty: not scored
};
RunScores score_run(
    const RunSpec& spec,
    const Scene& scene,
    const MeshProtocol& mesh,
    const std::function<void(std::string_view)>& scored
);

// As metrics.json has them: "metrics" (means) and "views" with their names.
Json scores_json(const RunScores& scores, const std::vector<View>& views);

struct ScoreOptions {
  MeshProtocol mesh;
  Scores cost;  // joins the means: "fps", "train-minutes", "peak-memory", "num-surfels", ...
  std::optional<TimingOptions> timing;  // that "fps" was measured by
  std::string truth;                    // truth_content()
  std::string render_key;               // of another program's renders, which have no stage
};

// The same, and writes metrics.json (means, per-view values with names, protocols). Returns the
// means by id; regions as "psnr@glass". Errors (kBadPrediction): a render is missing, damaged or of
// another size.
Scores eval_stage(const RunSpec& spec, const Scene& scene, const ScoreOptions& options = {});

}  // namespace glint
