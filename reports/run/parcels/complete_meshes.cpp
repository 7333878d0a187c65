// SPDX-License-Identifier: MIT
#include "reports/run/parcels/complete_meshes.h"

#include <algorithm>
#include <chrono>

#include "glint/core/file_lock.h"
#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "metrics/fusion/tsdf_volume.h"
#include "metrics/metric.h"
#include "reports/run/bench/mesh_eval.h"
#include "reports/run/bench/mesh_stage.h"
#include "reports/run/bench/run_record.h"
#include "reports/run/bench/run_stage.h"
#include "reports/run/bench/stage_documents.h"
#include "reports/run/parcels/take_parcel.h"
#include "reports/run/records/environment.h"
#include "reports/run/records/parcel_run.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kNote =
    "meshes: fused on another machine than the training's, from its depth within 0.1 mm (parcels)";

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void edit_json(const fs::path& file, const std::function<void(Json&)>& edit) {
  Json json = read_json_object(file, ExitCode::kBadPrediction);
  edit(json);
  write_file(file, json.dump(2) + "\n");
}

// One run: meshes, their scores, its record.
class Completion {
 public:
  Completion(const fs::path& run, const Record& record, const LoadedScene& loaded)
      : run_(run), record_(record), scene_(loaded.scene), parcel_(*parcel_of_run(run)) {
    edit_json(run / "config.json", [&](Json& json) {
      json["dataset_folder"] = loaded.folder.string();
    });
    spec_ = read_run_spec(run);
  }

  // The record with the meshes' scores.
  Record complete() {
    const auto start = Clock::now();
    const std::string why = make_meshes();
    record_.timings["mesh"] = seconds_since(start);
    score(why);
    write_file(run_ / kRecordFile, record_to_json(record_).dump() + "\n");
    return record_;
  }

  // Last: until now the next call would do it again.
  void note() const {
    edit_json(run_ / kParcelFile, [&](Json& json) { json["meshes"] = record_.meshes_made; });
  }

 private:
  std::string make_meshes() {
    const auto method = load_trained(spec_);
    const auto options = options_in<TsdfOptions>(parcel_.at("mesh_made_from"), "mesh");
    return try_mesh_stage(spec_, scene_, *method, options);
  }

  void score(const std::string& why) {
    Json scored = parcel_.at("score_made_from"), recipe = Json::object();
    const auto protocol = options_in<MeshProtocol>(scored, "mesh_metrics");
    const MeshValues values = score_meshes(spec_, scene_, protocol, recipe);
    edit_json(run_ / "metrics.json", [&](Json& json) {
      for (const auto& [id, value] : values) json["metrics"][id] = value;
      if (!recipe.empty()) json["meshes"] = recipe;
    });
    scored["inputs"]["mesh"] = key_of_stage(run_, Stage::kMesh);
    write_stage(run_, Stage::kScore, scored, stage_outputs(Stage::kScore));
    update_record(values, why, stage_key(scored));
  }

  void update_record(const MeshValues& values, const std::string& why, const std::string& key) {
    for (const Metric& metric : mesh_metric_list()) {
      record_.not_measured.erase(metric.id);
      if (!why.empty()) record_.not_measured[metric.id] = why;
    }
    record_.metrics.insert(values.begin(), values.end());
    for (std::string& id : meshes_without_truth(record_, spec_))
      record_.not_applicable.push_back(std::move(id));
    if (std::find(record_.notes.begin(), record_.notes.end(), kNote) == record_.notes.end())
      record_.notes.emplace_back(kNote);
    const Json here = environment_json();
    record_.meshes_made = {
        {"score_key", record_.score_key},
        {"depth_error_m", parcel_.value("depth_error_m", Json())}};
    for (const char* field : {"machine", "cpu", "device", "git_revision", "date"})
      if (here.contains(field)) record_.meshes_made[field] = here[field];
    record_.score_key = key;
  }

  fs::path run_;
  Record record_;
  const Scene& scene_;
  Json parcel_;
  RunSpec spec_;
};

class Completer {
 public:
  explicit Completer(const CompletionOptions& options)
      : options_(options), records_(read_records(options.folder / "records.jsonl")) {}

  std::vector<CompletedCell> run() {
    std::vector<Record> wanting;
    for (const Record& record : records_)
      if (wants_meshes(run_of(record), record)) wanting.push_back(record);
    std::stable_sort(wanting.begin(), wanting.end(), [](const Record& a, const Record& b) {
      return a.cell.scene < b.cell.scene;
    });
    const auto start = Clock::now();
    for (std::size_t i = 0; i < wanting.size(); ++i) {
      throw_if_interrupted();
      if (options_.write) tell(i, wanting, seconds_since(start));
      cells_.push_back(complete(wanting[i]));
      if (options_.write && !cells_.back().why_not.empty())
        log::warn(
            fmt::format("{}: without meshes: {}", wanting[i].cell.text(), cells_.back().why_not)
        );
    }
    return std::move(cells_);
  }

 private:
  fs::path run_of(const Record& record) const { return run_folder(options_.folder, record.cell); }

  // "[3/45] room_1/2dgs/0: meshes, 12m 30s left"
  static void tell(std::size_t i, const std::vector<Record>& all, double seconds) {
    std::string left;
    if (i > 0)
      left =
          ", " +
          format_duration(seconds / static_cast<double>(i) * static_cast<double>(all.size() - i)) +
          " left";
    log::info(fmt::format("[{}/{}] {}: meshes{}", i + 1, all.size(), all[i].cell.text(), left));
  }

  CompletedCell complete(const Record& record) {
    CompletedCell cell{record.cell};
    cell.why_not = why_not(record);
    if (!cell.why_not.empty() || !options_.write) {
      cell.made = cell.why_not.empty();
      return cell;
    }
    try {
      load_scene_of(record);
      cell.why_not = why_other_data(record);
      if (cell.why_not.empty()) make(record, cell);
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      cell.why_not = error.what();
    } catch (const nlohmann::json::exception&) {
      cell.why_not = (run_of(record) / kParcelFile).string() + ": damaged; merge the parcel again";
    }
    return cell;
  }

  void make(const Record& record, CompletedCell& cell) {
    const auto lock = FileLock::take(FileLock::file_beside(run_of(record)));
    if (const auto* holder = std::get_if<std::string>(&lock)) {
      cell.why_not = *holder + " is at work there";
      return;
    }
    Completion completion(run_of(record), record, loaded_);
    append_record(options_.folder / "records.jsonl", completion.complete());
    completion.note();
    cell.made = true;
  }

  // What is known before anything is loaded.
  std::string why_not(const Record& record) const {
    if (!fuse_stage.here() || !has_tsdf_volume()) return "no Open3D";
    if (!source_of(record))
      return fmt::format(
          "profile {} has no scene {} of {}",
          options_.profile.name,
          record.cell.scene,
          record.dataset
      );
    return {};
  }

  std::optional<SceneSource> source_of(const Record& record) const {
    for (SceneSource& source : options_.profile.sources())
      if (source.scene == record.cell.scene && source.dataset == record.dataset)
        return std::move(source);
    return std::nullopt;
  }

  void load_scene_of(const Record& record) {
    const std::string name = record.dataset + "/" + record.cell.scene;
    if (name == loaded_name_) return;
    loaded_name_.clear();
    loaded_ = options_.load(*source_of(record));
    loaded_name_ = name;
  }

  std::string why_other_data(const Record& record) const {
    if (loaded_.scene.spec_hash == record.dataset_hash) return {};
    return fmt::format(
        "{} is not what it was trained on (hash {}, there {})",
        loaded_.folder.string(),
        loaded_.scene.spec_hash.substr(0, 12),
        record.dataset_hash.substr(0, 12)
    );
  }

  const CompletionOptions& options_;
  std::vector<Record> records_;
  LoadedScene loaded_;
  std::string loaded_name_;
  std::vector<CompletedCell> cells_;
};

}  // namespace

std::vector<CompletedCell> complete_meshes(const CompletionOptions& options) {
  return Completer(options).run();
}

}  // namespace glint
