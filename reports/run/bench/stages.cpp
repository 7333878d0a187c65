// SPDX-License-Identifier: MIT
#include "reports/run/bench/stages.h"

#include <chrono>

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "reports/run/bench/mesh_eval.h"
#include "reports/run/bench/run_stage.h"
#include "reports/run/bench/stage_documents.h"
#include "reports/run/records/earlier_run.h"
#include "reports/show/pictures/strip.h"

namespace glint {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What frames a second depend on, beside the machine.
Json fps_protocol(const TimingOptions& timing) {
  return {
      {"frames", timing.frames},
      {"warmup", timing.warmup},
      {"clock", "all frames together, each ended by a synchronisation of the device"}};
}

void write_metrics(
    const RunSpec& spec,
    const RunScores& scores,
    const std::vector<View>& views,
    const std::optional<TimingOptions>& timing
) {
  Json json = {{"scene", spec.scene}, {"method", spec.method}, {"seed", spec.options.seed}};
  json.update(scores_json(scores, views));
  json["protocol"] = score_protocols();
  if (timing) json["protocol"]["fps"] = fps_protocol(*timing);
  if (!scores.meshes.empty()) json["meshes"] = scores.meshes;
  write_file(spec.folder / "metrics.json", json.dump(2) + "\n");
}

}  // namespace

std::unique_ptr<Method> load_trained(const RunSpec& spec) {
  finished_stage(spec.folder, Stage::kTrain, "train");
  auto method = create_method(spec.method, spec.config);
  with_exit_code(ExitCode::kBadPrediction, [&] { method->load(spec.folder.string()); });
  return method;
}

void render_stage(const RunSpec& spec, const Scene& scene, Method& method) {
  begin_stage(spec.folder, Stage::kRender);
  remove_renders(spec.folder / "renders");
  for (const View& view : scene.test) {
    throw_if_interrupted();
    const MapSet output = method.render_view(view);
    const Image& rgb = output["rgb"];
    GLINT_CHECK(
        rgb.size() == view.camera.size() && rgb.channels() == 3,
        kBadPrediction,
        "{} rendered {} as {}x{}x{}, expected {}x{}x3",
        spec.method,
        view.name,
        rgb.width(),
        rgb.height(),
        rgb.channels(),
        view.camera.width,
        view.camera.height
    );
    write_render(view_folder(spec.folder, view.name), output);
  }
  if (write_strips.here()) write_strips(spec.folder, scene.test);
  const std::string trained = key_of_stage(spec.folder, Stage::kTrain);
  end_stage(spec.folder, Stage::kRender, render_document(spec.method, trained));
}

double measure_fps(Method& method, const Scene& scene, const TimingOptions& options) {
  const auto render = [&](int frame) {
    method.picture(scene.test[static_cast<std::size_t>(frame) % scene.test.size()].camera);
    synchronize();
  };
  for (int frame = 0; frame < options.warmup; ++frame) render(frame);
  const auto start = Clock::now();
  for (int frame = 0; frame < options.frames; ++frame) render(frame);
  return options.frames / seconds_since(start);
}

RunScores score_run(
    const RunSpec& spec,
    const Scene& scene,
    const MeshProtocol& mesh,
    const std::function<void(std::string_view)>& scored
) {
  RunScores scores;
  for (const View& view : scene.test) {
    scores.views.push_back(with_exit_code(ExitCode::kBadPrediction, [&] {
      return score_view(view_folder(spec.folder, view.name), view);
    }));
    scored(view.name);
  }
  scores.means = mean_scores(scores.views);
  if (score_meshes.here()) scores.means.merge(score_meshes(spec, scene, mesh, scores.meshes));
  return scores;
}

Json scores_json(const RunScores& scores, const std::vector<View>& views) {
  Json json = {{"metrics", scores.means}, {"views", Json::array()}};
  for (std::size_t i = 0; i < views.size(); ++i)
    json["views"].push_back({{"name", views[i].name}, {"metrics", scores.views[i]}});
  return json;
}

Scores eval_stage(const RunSpec& spec, const Scene& scene, const ScoreOptions& options) {
  begin_stage(spec.folder, Stage::kScore);
  Progress progress("score", scene.test.size() + 1);  // the meshes last
  RunScores scores = score_run(spec, scene, options.mesh, [&](std::string_view view) {
    progress.advance(1, view);
  });
  progress.advance(1, "meshes");
  scores.means.insert(options.cost.begin(), options.cost.end());
  write_metrics(spec, scores, scene.test, options.timing);
  ScoreInputs inputs{options.render_key, key_of_stage(spec.folder, Stage::kMesh), options.truth};
  if (inputs.render_key.empty()) inputs.render_key = key_of_stage(spec.folder, Stage::kRender);
  end_stage(
      spec.folder, Stage::kScore, score_document(spec.method, inputs, options.mesh, options.timing)
  );
  return scores.means;
}

}  // namespace glint
