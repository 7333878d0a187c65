// SPDX-License-Identifier: MIT
// One run apart from any profile: train, render and eval on a folder of the user's.
#pragma once

#include "glint/core/file_lock.h"
#include "reports/bench/stages.h"
#include "reports/verbs/verb.h"

namespace glint {

struct SingleRunOptions {
  std::string dataset;  // folder
  std::string method = "2dgs";
  std::string run;                         // run folder; empty: OUT/single/runs/SCENE/METHOD/SEED
  double max_pixels = 0, image_ratio = 1;  // how pictures are shrunk (LoadOptions)
  bool force = false;                      // train again where a run is
};

// Errors (kUsage): no --dataset, unknown method or field, a run in the folder without `force`,
// another process at work there;
// kBadReference: the dataset.
struct SingleRun {
  RunSpec spec;
  Scene scene;
  std::optional<FileLock> lock;  // nobody else writes into the folder
  std::string data_warning;      // the data are not those it was trained on; empty: they are
};
SingleRun new_single_run(const CommonOptions& common, const SingleRunOptions& options);

struct ModelRunOptions {
  std::string model;  // Gaussians of another program: find_model()
  std::string dataset, run;
  std::string row = "model";  // in tables
  double max_pixels = 0;
  bool force = false;  // replaces the run that is there
};
// The same for a model that another program trained: it is read into the run's folder. Errors:
// new_single_run()'s, check_row_name()'s, import_model()'s.
SingleRun new_model_run(const CommonOptions& common, const ModelRunOptions& options);

// The run of a folder that `train` or `all` filled, with its dataset loaded again; from `dataset`
// (a folder or packed scene) where that is given, since the data may have moved. Other data than
// the run was trained on come with a warning. Errors (kBadPrediction): no run; kBadReference: the
// data.
SingleRun open_single_run(const std::string& run_folder, const std::string& dataset = "");

// --dataset of the verbs that open a run.
void add_moved_dataset_option(CLI::App& verb, std::string& dataset);

// The folder above ROOT/runs/SCENE/METHOD/SEED; empty: the run lies elsewhere.
fs::path root_of_run(const RunSpec& spec);

inline constexpr const char* kSingleProfile = "single";  // in records of runs apart from profiles

// Does the folder have records, all of single runs?
bool holds_single_runs(const fs::path& folder);

// Where the scores of a single run are recorded: ROOT/records.jsonl, else OUT/single/records.jsonl.
// Empty: ROOT is a profile's, whose records `all` keeps.
fs::path single_records_file(const CommonOptions& common, const RunSpec& spec);

}  // namespace glint
