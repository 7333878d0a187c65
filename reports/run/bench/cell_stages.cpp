// SPDX-License-Identifier: MIT
#include "reports/run/bench/cell_stages.h"

#include <algorithm>

#include "glint/core/presence.h"
#include "reports/run/bench/stage_documents.h"
#include "reports/run/records/parcel_run.h"

namespace glint {
namespace {

constexpr const char* kWithoutKeys = "by an earlier version, without a key";

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : ", ") + line;
  return text;
}

// The stages in front, of which some has changed.
std::string after_inputs(const Json& then, const Json& now) {
  std::string text;
  const Json before = then.value("inputs", Json::object());
  for (const auto& [stage, key] : now.at("inputs").items())
    if (!before.contains(stage) || before[stage] != key)
      text += (text.empty() ? "after " : ", ") + stage;
  return text;
}

// What the folder of a cell has of a stage that left no key.
std::string why_never(const fs::path& run, Stage stage, const Record* record) {
  const bool first = stage == Stage::kTrain;
  if (!first) return "not yet";
  if (!run.empty() && is_there(run / "env.json")) return std::string("trained ") + kWithoutKeys;
  if (!run.empty() && is_there(run / "config.json")) return "not trained to the end";
  if (record && record->train_key.empty()) return std::string("recorded ") + kWithoutKeys;
  return "not yet";
}

class Judge {
 public:
  Judge(const fs::path& run, const Record* record) : run_(run), record_(record) {}

  // What cannot be looked up is to do: the cell says so, and the others go on.
  StageState operator()(Stage stage, const Json& wanted) const try {
    const auto found = run_.empty() ? std::nullopt : read_stage(run_, stage);
    if (!found) return {false, run_.empty() ? "--force" : why_never(run_, stage, record_), wanted};
    const Json document = with_machine_of(wanted, found->document);
    if (stage_key(document) == stage_key(found->document)) {
      const std::string damage = what_is_damaged(run_, *found);
      return {damage.empty(), damage, damage.empty() ? document : wanted};
    }
    const auto changes = stage_differences(found->document, document);
    if (!changes.empty()) return {false, joined(changes), wanted};
    return {
        false,
        document.contains("inputs") ? after_inputs(found->document, document) : "after data",
        wanted};
  } catch (const Error& error) {
    return {false, error.what(), wanted};
  }

  // A stage that ended without a mesh is done for as long as no other memory is allowed.
  StageState mesh(const Json& wanted, const TsdfOptions& options) const {
    const auto found =
        run_.empty() ? std::nullopt : or_warn([&] { return read_stage(run_, Stage::kMesh); });
    const bool without = found && !found->note.empty();
    return (*this)(Stage::kMesh, without ? document_without_mesh(wanted, options) : wanted);
  }

 private:
  const fs::path& run_;
  const Record* record_;
};

Stage failed_stage(const Record& record) {
  for (const Stage stage : kStages)
    if (record.failure->stage == stage_name(stage)) return stage;
  return Stage::kScore;
}

// What is made from files that will be made again is made again, too.
void follow(CellStages& stages, Stage stage, const std::vector<Stage>& inputs) {
  StageState& state = stages[stage];
  for (const Stage input : inputs)
    if (state.done && !stages[input].done)
      state = {false, fmt::format("after {}", stage_name(input)), state.document};
}

// Files alone do not make a cell: what the records say about them counts too.
void heed_record(CellStages& stages, const Record* record) {
  StageState& score = stages[Stage::kScore];
  if (record && !record->ok()) {
    StageState& failed = stages[failed_stage(*record)];
    StageState& shown = failed.done ? score : failed;
    shown.done = false;
    shown.why = "failed earlier: " + record->failure->message;
  } else if (score.done && !record) {
    score = {false, "not in the records", score.document};
  } else if (score.done && record->score_key != score.key()) {
    score = {false, std::string("the record is of other files"), score.document};
  }
}

// What came in a parcel has neither colours nor renders to go on from.
void heed_parcel(CellStages& stages, const fs::path& run) {
  const bool whole = stages[Stage::kRender].done && stages[Stage::kScore].done;
  if (whole || !stages[Stage::kTrain].done || !parcel_of_run(run)) return;
  StageState& train = stages[Stage::kTrain];
  train = {false, "its run came in a parcel, without colours", train.document};
  follow(stages, Stage::kRender, {Stage::kTrain});
  follow(stages, Stage::kMesh, {Stage::kTrain});
  follow(stages, Stage::kScore, {Stage::kRender, Stage::kMesh});
}

}  // namespace

bool CellStages::done() const {
  return std::all_of(states_.begin(), states_.end(), [](const StageState& state) {
    return state.done;
  });
}

std::string CellStages::why() const {
  std::string text;
  for (const Stage stage : kStages)
    if (const StageState& state = (*this)[stage]; !state.done)
      text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", stage_name(stage), state.why);
  return text;
}

std::vector<std::string> stages_to_do(const CellStages& stages) {
  std::vector<std::string> names;
  for (const Stage stage : kStages)
    if (!stages[stage].done && stage != Stage::kData) names.emplace_back(stage_name(stage));
  return names;
}

CellStages cell_stages(
    const PlanCell& cell,
    const Profile& profile,
    const SceneIdentity& scene,
    const Record* record,
    const fs::path& run
) {
  const std::string& method = cell.cell.method;
  const Judge judge(run, record);
  CellStages stages;
  stages[Stage::kData] = {scene.why_not.empty(), scene.why_not, scene.document};
  stages[Stage::kTrain] = judge(
      Stage::kTrain,
      train_document(method, cell.config, {profile.iterations, cell.cell.seed}, scene.document)
  );
  const std::string train_key = stages[Stage::kTrain].key();
  stages[Stage::kRender] = judge(Stage::kRender, render_document(method, train_key));
  const TsdfOptions fusion = profile.tsdf_options();
  const Json mesh = mesh_document(method, train_key, fusion);
  stages[Stage::kMesh] = judge.mesh(mesh, fusion);
  for (const Stage stage : {Stage::kRender, Stage::kMesh}) follow(stages, stage, {Stage::kTrain});
  if (!stages[Stage::kMesh].done) stages[Stage::kMesh].document = mesh;  // there may be one now
  stages[Stage::kScore] = judge(
      Stage::kScore,
      score_document(
          method,
          {stages[Stage::kRender].key(), stages[Stage::kMesh].key(), scene.truth},
          profile.mesh_protocol(),
          TimingOptions{profile.timing_frames, profile.timing_warmup}
      )
  );
  follow(stages, Stage::kScore, {Stage::kRender, Stage::kMesh});
  heed_record(stages, record);
  heed_parcel(stages, run);
  return stages;
}

}  // namespace glint
