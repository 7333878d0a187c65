// SPDX-License-Identifier: MIT
#include "reports/verbs/single_run.h"

#include <algorithm>

#include "datasets/dataset.h"
#include "glint/core/progress.h"
#include "glint/train/checkpoint.h"
#include "reports/bench/stage_documents.h"
#include "reports/import/import_model.h"
#include "reports/records/code_hashes.h"
#include "reports/records/earlier_run.h"
#include "reports/records/stage_files.h"

namespace glint {

namespace {

constexpr int kDefaultIterations = 7000;  // of `train` without --iterations

Scene load_dataset(const RunSpec& spec) {
  LoadOptions options;
  options.max_pixels = spec.max_pixels;
  options.image_ratio = spec.image_ratio;
  return with_exit_code(ExitCode::kBadReference, [&] {
    return load_scene(spec.dataset_folder, options);
  });
}

FileLock lock_of(const fs::path& run) {
  auto lock = FileLock::take(FileLock::file_beside(run));
  if (const auto* holder = std::get_if<std::string>(&lock))
    throw Error(
        ExitCode::kUsage,
        fmt::format(
            "{}: {} is at work there; wait for it, or choose another --run", run.string(), *holder
        )
    );
  return std::get<FileLock>(std::move(lock));
}

// `identity`: of a training that may go on there.
void check_new_run(const fs::path& folder, bool force, const std::string& identity) {
  const bool goes_on = is_checkpoint_of(folder / kCheckpointFile, identity);
  GLINT_CHECK(
      force || goes_on || !holds_work(folder),
      kUsage,
      "{}: holds {}; --force replaces it, --run names another folder",
      folder.string(),
      fs::exists(folder / "env.json") ? "a run already"
                                      : "a training that was cut off and has other settings, data "
                                        "or code, so that it cannot go on"
  );
  check_run_folder(folder);
}

// The scene of single.spec, whose method, config and options are known, and the training's
// document.
void open_data(
    const CommonOptions& common,
    const std::string& dataset,
    const LoadOptions& shrinking,
    SingleRun& single
) {
  RunSpec& spec = single.spec;
  spec.dataset_folder = fs::absolute(dataset);
  spec.max_pixels = shrinking.max_pixels;
  spec.image_ratio = shrinking.image_ratio;
  single.scene = load_dataset(spec);
  spec.dataset = single.scene.dataset;
  spec.scene = single.scene.name;
  spec.dataset_hash = single.scene.spec_hash;
  const Json data = data_document(spec.dataset_folder, shrinking, common.data);
  spec.train_document = train_document(spec.method, spec.config, spec.options, data);
}

// `run`; empty: where single runs lie below OUT.
void take_folder(const CommonOptions& common, const std::string& run, SingleRun& single) {
  RunSpec& spec = single.spec;
  const fs::path root = fs::path(common.out) / kSingleProfile;
  spec.folder = run.empty() ? run_folder(root, spec.cell()) : fs::path(run);
  single.lock.emplace(lock_of(spec.folder));
}

}  // namespace

SingleRun new_single_run(const CommonOptions& common, const SingleRunOptions& options) {
  find_method(options.method);
  SingleRun single;
  RunSpec& spec = single.spec;
  spec.method = options.method;
  spec.config = method_overrides(Profile{}, options.method, common.set);
  spec.options.iterations = common.iterations > 0 ? common.iterations : kDefaultIterations;
  spec.options.seed = common.seed.value_or(0);
  LoadOptions shrinking;
  shrinking.max_pixels = options.max_pixels;
  shrinking.image_ratio = options.image_ratio;
  open_data(common, options.dataset, shrinking, single);
  take_folder(common, options.run, single);
  spec.checkpoint_seconds = common.checkpoint_seconds;
  spec.test_psnr_every = common.test_psnr_every.value_or(0);
  spec.anew = options.force;
  check_new_run(spec.folder, options.force, stage_key(spec.train_document));
  return single;
}

SingleRun new_model_run(const CommonOptions& common, const ModelRunOptions& options) {
  check_row_name(options.row);
  const ModelFiles files = find_model(options.model);
  SingleRun single;
  RunSpec& spec = single.spec;
  spec.method = files.method;
  spec.row = options.row;
  spec.config = files.config;
  spec.config.update(method_overrides(Profile{}, files.method, common.set));
  spec.options = {.iterations = 0, .seed = common.seed.value_or(0)};
  open_data(common, options.dataset, {.max_pixels = options.max_pixels}, single);
  spec.train_document["model"] = {
      {"content", content_hash(options.model, fs::path(common.data) / ".hashes")},
      {"code", code_json({"model"})}};
  take_folder(common, options.run, single);
  check_new_run(spec.folder, options.force, {});
  for (const std::string& note : import_model(options.model, files, spec)) log::info(note);
  return single;
}

SingleRun open_single_run(const std::string& run_folder, const std::string& dataset) {
  SingleRun single;
  RunSpec& spec = single.spec;
  spec = read_run_spec(run_folder);
  single.lock.emplace(lock_of(run_folder));
  if (!dataset.empty()) spec.dataset_folder = fs::absolute(dataset);
  std::error_code code;
  GLINT_CHECK(
      !dataset.empty() || fs::exists(spec.dataset_folder, code),
      kBadReference,
      "{}: not there, but {} was trained on it; if the data have moved, give --dataset FOLDER",
      spec.dataset_folder.string(),
      run_folder
  );
  single.scene = load_dataset(spec);
  if (const std::string& hash = single.scene.spec_hash;
      !spec.dataset_hash.empty() && hash != spec.dataset_hash) {
    single.data_warning = fmt::format(
        "{} is not what {} was trained on (hash {}, then {})",
        spec.dataset_folder.string(),
        run_folder,
        hash.substr(0, 12),
        spec.dataset_hash.substr(0, 12)
    );
    log::warn(single.data_warning);
  }
  return single;
}

fs::path root_of_run(const RunSpec& spec) {
  const fs::path cell = fs::path("runs") / spec.cell().text();
  fs::path root = fs::absolute(spec.folder / "").lexically_normal().parent_path();
  for (auto part = cell.end(); part != cell.begin();) {
    if (root.filename() != *--part) return {};
    root = root.parent_path();
  }
  return root;
}

bool holds_single_runs(const fs::path& folder) {
  const auto records = read_records(folder / "records.jsonl");
  return !records.empty() && std::all_of(records.begin(), records.end(), [](const Record& record) {
    return record.profile == kSingleProfile;
  });
}

fs::path single_records_file(const CommonOptions& common, const RunSpec& spec) {
  const fs::path root = root_of_run(spec);
  if (root.empty()) return fs::path(common.out) / kSingleProfile / "records.jsonl";
  for (const Record& record : read_records(root / "records.jsonl"))
    if (record.profile != kSingleProfile) return {};
  return root / "records.jsonl";
}

void add_moved_dataset_option(CLI::App& verb, std::string& dataset) {
  verb.add_option(
      "--dataset",
      dataset,
      "where the run's data are now, if they have moved: folder or packed scene"
  );
}

}  // namespace glint
