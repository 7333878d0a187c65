// SPDX-License-Identifier: MIT
#include "reports/run/provenance/verify_run.h"

#include <algorithm>
#include <map>

#include "datasets/dataset.h"
#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "reports/run/bench/run_stage.h"
#include "reports/run/bench/stage_documents.h"
#include "reports/run/provenance/compare_scores.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/merge_runs.h"
#include "reports/run/records/parcel_run.h"

namespace glint {
namespace {

constexpr std::size_t kNamed = 3;  // of several findings
constexpr std::array kRunStages{Stage::kTrain, Stage::kRender, Stage::kMesh, Stage::kScore};

std::string some_of(const std::vector<std::string>& lines, const char* between = ", ") {
  std::string text;
  for (std::size_t i = 0; i < std::min(lines.size(), kNamed); ++i)
    text += (i > 0 ? between : "") + lines[i];
  if (lines.size() > kNamed) text += fmt::format(" and {} more", lines.size() - kNamed);
  return text;
}

std::string text_of(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

// The key of a stage in front, as a document names it.
std::string input_of(const Json& document, Stage stage) {
  return document.contains("inputs")
             ? text_of(document["inputs"], std::string(stage_name(stage)).c_str())
             : "";
}

Json document_now(
    Stage stage, const RunSpec& spec, const Json& then, const Json& data, const fs::path& hashes
) {
  if (stage == Stage::kTrain) return train_document(spec.method, spec.config, spec.options, data);
  const std::string trained = input_of(then, Stage::kTrain);
  if (stage == Stage::kRender) return render_document(spec.method, trained);
  if (stage == Stage::kMesh) {
    const auto options = options_in<TsdfOptions>(then, "mesh");
    const Json document = mesh_document(spec.method, trained, options);
    const bool without = then.at("mesh").contains("max_memory_mb");
    return without ? document_without_mesh(document, options) : document;
  }
  std::optional<TimingOptions> timing;
  if (then.at("timing_frames").is_number())
    timing = TimingOptions{then["timing_frames"], then.at("timing_warmup")};
  return score_document(
      spec.method,
      {input_of(then, Stage::kRender),
       input_of(then, Stage::kMesh),
       truth_content(spec.dataset_folder, hashes)},
      options_in<MeshProtocol>(then, "mesh_metrics"),
      timing
  );
}

// What records.jsonl says otherwise, field by field. `also_judged`: also what the run itself tells.
std::vector<std::string> record_differences(
    const Record& file, const Record& recorded, bool also_judged
) {
  const auto fields = [&](const Record& record) {
    Json json = record_to_json(record);
    if (!also_judged)
      for (const char* name : {"metrics", "train_key", "score_key", "dataset_hash"})
        json.erase(name);
    return json.flatten();
  };
  const Json a = fields(file), b = fields(recorded);
  Json both = a;
  both.update(b);
  std::vector<std::string> differing;
  for (const auto& entry : both.items()) {
    const Json here = a.value(entry.key(), Json()), there = b.value(entry.key(), Json());
    if (here != there)
      differing.push_back(fmt::format(
          "{} {}, records.jsonl has {}", entry.key().substr(1), here.dump(), there.dump()
      ));
  }
  return differing;
}

// Files of ours that a stage would have written, and has not.
std::vector<std::string> added_files(const fs::path& run, Stage stage, const StageFile& done) {
  std::vector<std::string> added;
  const auto outputs = stage_outputs(stage);
  for (const fs::path& file : files_of_run(run)) {
    const std::string name = file.lexically_relative(run).generic_string();
    const std::string top = name.substr(0, name.find('/'));
    const bool of_stage = std::find(outputs.begin(), outputs.end(), top) != outputs.end();
    if (of_stage && !done.files.contains(name)) added.push_back(name + " was added");
  }
  return added;
}

}  // namespace

// One run, check by check.
class RunExamination {
 public:
  RunExamination(RunVerifier& verifier, const RunToVerify& run)
      : verifier_(verifier), run_(run), spec_(read_run_spec(run.folder)) {
    if (!run.dataset.empty()) spec_.dataset_folder = fs::absolute(run.dataset);
    parcel_ = parcel_of_run(run.folder).has_value();
    for (const Stage stage : kRunStages)
      if (why_unreadable(run.folder, stage).empty())
        if (const auto done = read_stage(run.folder, stage)) done_.emplace(stage, *done);
    imported_ = !is_taken(run.folder / "keys/train.json") &&
                !Registry<MethodSpec>::all().contains(spec_.method);
  }

  std::vector<Checked> examine() {
    guarded("config", [&] { check_config(); });
    guarded("data", [&] { check_data(); });
    for (const Stage stage : kRunStages)
      guarded(std::string(stage_name(stage)), [&] { check_stage(stage); });
    guarded("record", [&] { check_record(); });
    guarded(kRecordFile, [&] { check_record_file(); });
    guarded("cost", [&] { check_cost(); });
    guarded("metrics", [&] { check_scores(); });
    return std::move(rows_);
  }

 private:
  void add(std::string name, CheckState state, std::string detail) {
    rows_.push_back({std::move(name), state, std::move(detail)});
  }
  void add(const std::string& name, const std::vector<std::string>& wrong, std::string good) {
    const bool ok = wrong.empty();
    add(name, ok ? CheckState::kOk : CheckState::kBad, ok ? std::move(good) : some_of(wrong));
  }

  // What cannot be looked at does not match.
  template <class F>
  void guarded(const std::string& name, F&& check) try {
    check();
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    add(name, CheckState::kBad, error.what());
  }

  const StageFile* done(Stage stage) const {
    const auto found = done_.find(stage);
    return found == done_.end() ? nullptr : &found->second;
  }
  const Record* finished_record() const {
    return run_.record && run_.record->ok() ? run_.record : nullptr;
  }
  std::string key_of(Stage stage) const {
    return done(stage) ? stage_key(done(stage)->document) : "";
  }

  void check_config() {
    const StageFile* trained = done(Stage::kTrain);
    if (!trained) return;
    const Json& document = trained->document;
    const auto fields = [](const auto& method, int iterations, auto seed, const Json& config) {
      return Json{
          {"method", method}, {"iterations", iterations}, {"seed", seed}, {"config", config}};
    };
    const Json written = read_json_object(run_.folder / "config.json", ExitCode::kBadPrediction);
    add("config",
        stage_differences(
            fields(
                document.at("method"),
                document.at("iterations"),
                document.at("seed"),
                document.at("config")
            ),
            fields(spec_.method, spec_.options.iterations, spec_.options.seed, written.at("config"))
        ),
        "config.json is what was trained");
  }

  void check_data() {
    if (!is_there(spec_.dataset_folder))
      return add(
          "data",
          parcel_ ? CheckState::kNote : CheckState::kBad,
          spec_.dataset_folder.string() + ": not there; if the data have moved, give --dataset"
      );
    std::vector<std::string> wrong;
    const StageFile* trained = done(Stage::kTrain);
    if (trained && !parcel_) compare_data(trained->document.at("data"), wrong);
    if (!verifier_.fast_) {
      scene_ = &verifier_.scene_of(spec_, run_.loader);
      if (!spec_.dataset_hash.empty() && scene_->spec_hash != spec_.dataset_hash)
        wrong.push_back(fmt::format(
            "hash {}, was {}", scene_->spec_hash.substr(0, 12), spec_.dataset_hash.substr(0, 12)
        ));
    } else if (!trained) {
      return add("data", CheckState::kNote, "not looked at: --fast");
    }
    if (parcel_ && wrong.empty())
      return add(
          "data",
          CheckState::kNote,
          "the run came in a parcel: trained on the same scene, in files of another machine"
      );
    add("data", wrong, spec_.dataset_folder.string());
    has_other_data_ = !wrong.empty();
  }

  void compare_data(const Json& then, std::vector<std::string>& wrong) {
    const fs::path& data = spec_.dataset_folder;
    data_now_ = data_document_now(then, data, verifier_.hashes_.path(), run_.loader);
    if (data_now_.at("content") != then.at("content"))
      wrong.push_back(data.string() + ": other files than at training");
    if (!then.at("scene").contains("spp")) return;
    const auto made = read_stage(data, Stage::kData);
    if (!made)
      return wrong.push_back((data / "keys/data.json").string() + ": not there or damaged");
    for (const std::string& change : changed_files(data, *made)) wrong.push_back(change);
  }

  void check_stage(Stage stage) {
    const std::string name(stage_name(stage));
    const std::string why = why_unreadable(run_.folder, stage);
    if (!why.empty()) return add(name + " key", CheckState::kBad, "keys/" + name + ".json: " + why);
    if (!done(stage)) return add_absent(stage);
    add(name + " key", wrong_inputs(stage), key_of(stage));
    check_files(stage);
    compare_with_now(stage);
  }

  // Renders of another program have no stages in front of the scores.
  void add_absent(Stage stage) {
    if (imported_ && stage != Stage::kScore) return;
    bool needed = finished_record() && (stage == Stage::kTrain || stage == Stage::kScore);
    for (const Stage later : kRunStages)
      needed = needed || (done(later) && !input_of(done(later)->document, stage).empty());
    const std::string name(stage_name(stage));
    add(name + " key",
        needed ? CheckState::kBad : CheckState::kNote,
        fmt::format("no keys/{}.json: not run to the end, or by an earlier version", name));
  }

  std::vector<std::string> wrong_inputs(Stage stage) const {
    std::vector<std::string> wrong;
    if (imported_) return wrong;
    for (const Stage input : kRunStages) {
      const std::string key = input_of(done(stage)->document, input);
      if (!key.empty() && done(input) && key != key_of(input))
        wrong.push_back(
            fmt::format("made from {} {}, which is {}", stage_name(input), key, key_of(input))
        );
    }
    return wrong;
  }

  void check_files(Stage stage) {
    const StageFile& file = *done(stage);
    std::vector<std::string> wrong = changed_files(run_.folder, file);
    for (std::string& line : added_files(run_.folder, stage, file))
      wrong.push_back(std::move(line));
    const std::string name = std::string(stage_name(stage)) + " files";
    const bool sizes_only = !file.files.empty() && file.hashes.empty();
    if (wrong.empty() && sizes_only)
      return add(name, CheckState::kNote, "only their sizes: an earlier version wrote no hashes");
    add(name, wrong, fmt::format("{}", file.files.size()));
  }

  // Other code or other defaults do not make a run wrong: what it was made from is on record.
  void compare_with_now(Stage stage) {
    const Json& then = done(stage)->document;
    const std::string name = std::string(stage_name(stage)) + " now";
    try {
      const Json now = with_machine_of(
          document_now(stage, spec_, then, data_for(then), verifier_.hashes_.path()), then
      );
      auto changes = stage_differences(then, now);
      if (stage == Stage::kTrain && has_other_data_ && changes.empty())
        changes.emplace_back("other files in the data");  // of a room, which its document is not of
      if (changes.empty()) return add(name, CheckState::kOk, "made from what there is now");
      add(name, CheckState::kNote, "would now be made anew: " + some_of(changes));
    } catch (const Error& error) {
      add(name, CheckState::kNote, std::string("cannot be made now: ") + error.what());
    }
  }

  Json data_for(const Json& then) const {
    if (!then.contains("data")) return {};
    return data_now_.is_null() ? then["data"] : data_now_;
  }

  void check_record() {
    if (!run_.record) return add("record", CheckState::kNote, "not recorded");
    const Record& record = *run_.record;
    if (!record.ok()) return add("record", CheckState::kNote, "failed: " + record.failure->message);
    if (record.score_key.empty())
      return add("record", CheckState::kNote, "by an earlier version, without keys");
    add("record", wrong_in(record), fmt::format("{} values", record.metrics.size()));
  }

  // `merge` adopts a run by it. Single runs and earlier versions have none.
  void check_record_file() {
    const fs::path file = run_.folder / kRecordFile;
    if (!is_file(file)) return;
    const Record record = record_from_json(read_json_object(file), file.string());
    const bool has_keys = record.ok() && !record.score_key.empty();
    std::vector<std::string> wrong;
    if (has_keys) wrong = wrong_in(record);
    if (run_.record)
      for (std::string& line : record_differences(record, *run_.record, !has_keys))
        wrong.push_back(std::move(line));
    add(kRecordFile, wrong, fmt::format("{} values", record.metrics.size()));
  }

  // Against the keys of the run and its scores.
  std::vector<std::string> wrong_in(const Record& record) const {
    std::vector<std::string> wrong;
    const auto compare = [&](const char* what, const std::string& recorded, const std::string& is) {
      if (recorded != is)
        wrong.push_back(fmt::format("{} {}, the run's is {}", what, recorded, is));
    };
    compare("train_key", record.train_key, key_of(Stage::kTrain));
    compare("score_key", record.score_key, key_of(Stage::kScore));
    compare("dataset_hash", record.dataset_hash, spec_.dataset_hash);
    compare_recorded_metrics(record, wrong);
    return wrong;
  }

  void compare_recorded_metrics(const Record& record, std::vector<std::string>& wrong) const {
    const Json means = metrics_file().value("metrics", Json::object());
    const Json recorded(record.metrics);
    const auto compare = [&](const Json& ids) {
      for (const auto& entry : ids.items()) {
        const std::string& id = entry.key();
        const Json there = means.value(id, Json()), here = recorded.value(id, Json());
        if (there == here) continue;
        std::string line = fmt::format("{} {}, metrics.json has {}", id, here.dump(), there.dump());
        if (std::find(wrong.begin(), wrong.end(), line) == wrong.end()) wrong.push_back(line);
      }
    };
    compare(means);
    compare(recorded);
  }

  Json metrics_file() const {
    return read_json_object(run_.folder / "metrics.json", ExitCode::kBadPrediction);
  }

  // What training took stands in env.json; scores and records carry it on.
  void check_cost() {
    const auto cost = trained_cost(spec_);
    if (!cost || !done(Stage::kScore)) return;
    const Json means = metrics_file().value("metrics", Json::object());
    std::vector<std::string> wrong;
    const auto compare = [&](const char* id, double value) {
      if (means.value(id, value) != value)
        wrong.push_back(fmt::format("{} {}, env.json says {}", id, means[id].dump(), value));
    };
    compare("train-minutes", cost->seconds / 60);
    compare("peak-memory", cost->peak_memory_mb);
    compare("device-memory", cost->device_memory_mb);
    add("cost", wrong, "as env.json says");
  }

  void check_scores() {
    const StageFile* scored = done(Stage::kScore);
    if (!scored) return;
    if (verifier_.fast_) return add("metrics", CheckState::kNote, "not computed again: --fast");
    if (parcel_)
      return add(
          "metrics",
          CheckState::kNote,
          "not computed again: the run came in a parcel, without its renders"
      );
    if (!scene_)
      return add("metrics", CheckState::kBad, "cannot be computed again without the data");
    const RunScores now = score_run(
        spec_,
        *scene_,
        options_in<MeshProtocol>(scored->document, "mesh_metrics"),
        [](std::string_view) { throw_if_interrupted(); }
    );
    add_scores(compare_scores(metrics_file(), scores_json(now, scene_->test)));
  }

  void add_scores(const ScoreComparison& found) {
    if (!found.differing.empty()) return add("metrics", found.differing, "");
    std::string text = fmt::format("{} values equal to the last digit", found.equal);
    const auto tell = [&](const char* what, const std::vector<std::string>& ids) {
      if (!ids.empty()) text += fmt::format("; {}: {}", what, fmt::join(ids, ", "));
    };
    tell("not computed again", found.not_recomputed);
    if (!found.rounded.empty())
      text +=
          fmt::format("; {} differ by rounding: {}", found.rounded.size(), some_of(found.rounded));
    tell("not scored then", found.added);
    const bool exact = found.rounded.empty() && found.added.empty();
    add("metrics", exact ? CheckState::kOk : CheckState::kNote, text);
  }

  RunVerifier& verifier_;
  const RunToVerify& run_;
  RunSpec spec_;
  std::map<Stage, StageFile> done_;
  bool imported_ = false;
  bool parcel_ = false;  // what did not come along is no damage
  bool has_other_data_ = false;
  Json data_now_;
  const Scene* scene_ = nullptr;
  std::vector<Checked> rows_;
};

std::vector<Checked> RunVerifier::verify(const RunToVerify& run) {
  return RunExamination(*this, run).examine();
}

const Scene& RunVerifier::scene_of(const RunSpec& spec, const std::string& loader) {
  const std::string name = fmt::format(
      "{}\n{}\n{}\n{}", spec.dataset_folder.string(), spec.max_pixels, spec.image_ratio, loader
  );
  if (name == scene_name_) return scene_;
  LoadOptions options;
  options.max_pixels = spec.max_pixels;
  options.image_ratio = spec.image_ratio;
  options.loader = loader;
  scene_name_.clear();
  scene_ = load_scene(spec.dataset_folder, options);
  scene_name_ = name;
  return scene_;
}

}  // namespace glint
