// SPDX-License-Identifier: MIT
#include "reports/verbs/single_cell.h"

#include <algorithm>

#include "datasets/holdout.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/train/checkpoint.h"
#include "reports/run/bench/stage_documents.h"
#include "reports/run/import/import_model.h"
#include "reports/run/records/code_hashes.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/stage_files.h"

namespace glint {

namespace {

constexpr int kDefaultIterations = 7000;  // of `train` without --iterations

// A training of the same document may go on there.
void check_new_run(const RunSpec& spec) {
  const fs::path& folder = spec.folder;
  const auto goes_on = [&] {
    return is_checkpoint_of(folder / kCheckpointFile, stage_key(spec.train_document));
  };
  GLINT_CHECK(
      spec.anew || goes_on() || !holds_work(folder),
      kUsage,
      "{}: holds {}; --force replaces it, --run names another folder",
      folder.string(),
      is_there(folder / "env.json") ? "a run already"
                                    : "a training that was cut off and has other settings, data "
                                      "or code, so that it cannot go on"
  );
  check_run_folder(folder);
}

// A cell without its data.
PlanCell cell_to_train(const CommonOptions& common, const NewCellOptions& options) {
  find_method(options.method);
  return {
      {"", options.method, common.seed.value_or(0)},
      {},
      method_overrides(Profile{}, options.method, common.set)};
}

PlanCell cell_of_model(const CommonOptions& common, const ModelFiles& files) {
  PlanCell cell{{"", files.method, common.seed.value_or(0)}, {}, files.config};
  cell.config.update(method_overrides(Profile{}, files.method, common.set));
  return cell;
}

// Errors (kUsage): test views would be scored while it trains.
void tell_held_out(const LoadedScene& loaded, const Profile& profile) {
  GLINT_CHECK(
      profile.test_psnr_every == 0,
      kUsage,
      "{}: {}; leave out --test-psnr-every",
      loaded.folder.string(),
      kHeldOutNote
  );
  log::info(fmt::format("{}: {}", loaded.folder.string(), kHeldOutNote));
}

SingleCell with_data(
    const CommonOptions& common,
    const NewCellOptions& options,
    PlanCell cell,
    const Profile& profile
) {
  cell.source.max_pixels = options.max_pixels;
  cell.source.image_ratio = options.image_ratio;
  LoadedScene loaded = with_exit_code(ExitCode::kBadReference, [&] {
    return load_user_data(cell.source, options.dataset);
  });
  cell.cell.scene = cell.source.scene;
  SingleCell single;
  RunSpec& spec = single.spec;
  if (is_held_out(loaded.scene)) tell_held_out(loaded, profile);
  spec = make_spec(cell, profile, loaded, options.run);
  spec.checkpoint_seconds = common.checkpoint_seconds;
  spec.anew = options.force;
  if (!options.model.empty()) spec.row = options.method;
  if (options.run.empty())
    spec.folder = run_folder(fs::path(common.out) / kSingleProfile, spec.cell());
  spec.train_document = train_document(
      spec.method, spec.config, spec.options, identify_source(cell.source, common.data).document
  );
  single.scene = std::move(loaded.scene);
  single.lock.emplace(lock_run(spec.folder));
  return single;
}

SingleCell cell_with_model(const CommonOptions& common, const NewCellOptions& options) {
  check_row_name(options.method);
  const ModelFiles files = find_model(options.model);
  SingleCell single =
      with_data(common, options, cell_of_model(common, files), single_profile(common, 0));
  RunSpec& spec = single.spec;
  spec.train_document["model"] = {
      {"content", content_hash(options.model, fs::path(common.data) / ".hashes")},
      {"code", code_json({"model"})}};
  check_new_run(spec);
  for (const std::string& note : import_model(options.model, files, spec)) log::info(note);
  return single;
}

}  // namespace

FileLock lock_run(const fs::path& run, std::string_view otherwise) {
  auto lock = FileLock::take(FileLock::file_beside(run));
  if (const auto* holder = std::get_if<std::string>(&lock))
    throw Error(
        ExitCode::kUsage,
        fmt::format("{}: {} is at work there; wait for it, or {}", run.string(), *holder, otherwise)
    );
  return std::get<FileLock>(std::move(lock));
}

Profile single_profile(const CommonOptions& common, int iterations) {
  Profile profile;
  profile.name = kSingleProfile;
  profile.iterations = iterations;
  profile.test_psnr_every = common.test_psnr_every.value_or(0);
  return profile;
}

SingleCell new_single_cell(const CommonOptions& common, const NewCellOptions& options) {
  if (!options.model.empty()) return cell_with_model(common, options);
  const int iterations = common.iterations > 0 ? common.iterations : kDefaultIterations;
  SingleCell single = with_data(
      common, options, cell_to_train(common, options), single_profile(common, iterations)
  );
  check_new_run(single.spec);
  return single;
}

SingleCell open_single_cell(const std::string& run_folder, const std::string& dataset) {
  SingleCell single;
  RunSpec& spec = single.spec;
  spec = read_run_spec(run_folder);
  single.lock.emplace(lock_run(run_folder));
  if (!dataset.empty()) spec.dataset_folder = fs::absolute(dataset);
  GLINT_CHECK(
      !dataset.empty() || is_there(spec.dataset_folder),
      kBadReference,
      "{}: not there, but {} was trained on it; if the data have moved, give --dataset FOLDER",
      spec.dataset_folder.string(),
      run_folder
  );
  SceneSource source;
  source.max_pixels = spec.max_pixels;
  source.image_ratio = spec.image_ratio;
  single.scene = with_exit_code(ExitCode::kBadReference, [&] {
    return load_user_data(source, spec.dataset_folder).scene;
  });
  const std::string& hash = single.scene.spec_hash;
  if (spec.dataset_hash.empty() || hash == spec.dataset_hash) return single;
  single.data_warning = fmt::format(
      "{} is not what {} was trained on (hash {}, then {})",
      spec.dataset_folder.string(),
      run_folder,
      hash.substr(0, 12),
      spec.dataset_hash.substr(0, 12)
  );
  log::warn(single.data_warning);
  return single;
}

LoadedScene load_user_data(SceneSource& source, const fs::path& dataset) {
  source.folder = fs::absolute(dataset).string();
  LoadedScene loaded = load_source(source, {});
  source.scene = loaded.scene.name;
  source.dataset = loaded.scene.dataset;
  note_held_out(dataset, loaded.scene);
  return loaded;
}

fs::path records_folder(const CommonOptions& common, const RunSpec& spec) {
  const fs::path run = absolute_folder(spec.folder);
  fs::path root = run;
  for ([[maybe_unused]] const fs::path& part : run_folder({}, spec.cell()))
    root = root.parent_path();
  return run_folder(root, spec.cell()) == run ? root : fs::path(common.out) / kSingleProfile;
}

bool holds_single_runs(const fs::path& folder) {
  const auto records = read_records(folder / "records.jsonl");
  return !records.empty() && std::all_of(records.begin(), records.end(), [](const Record& record) {
    return record.profile == kSingleProfile;
  });
}

void add_moved_dataset_option(CLI::App& verb, std::string& dataset) {
  verb.add_option(
      "--dataset",
      dataset,
      "where the run's data are now, if they have moved: folder or packed scene"
  );
}

}  // namespace glint
