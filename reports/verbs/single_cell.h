// SPDX-License-Identifier: MIT
// A run apart from any profile is the cell of a profile in memory, `single`, whose one scene is a
// folder of the user's: `train`, `render`, `mesh` and `eval` bring it to their stage.
#pragma once

#include "glint/core/file_lock.h"
#include "reports/run/bench/run_record.h"
#include "reports/verbs/verb.h"

namespace glint {

inline constexpr const char* kSingleProfile = "single";
Profile single_profile(const CommonOptions& common, int iterations);

struct SingleCell {
  RunSpec spec;
  Scene scene;
  std::optional<FileLock> lock;  // nobody else writes into the folder
  std::string data_warning;      // the data are not those it was trained on; empty: they are
};

struct NewCellOptions {
  std::string dataset;          // folder or packed scene
  std::string run;              // folder; empty: OUT/single/runs/SCENE/METHOD/SEED
  std::string method = "2dgs";  // id; of a model its row in tables
  std::string model;            // Gaussians of another program (find_model()); empty: to be trained
  double max_pixels = 0, image_ratio = 1;  // how pictures are shrunk (LoadOptions)
  bool force = false;                      // replaces a run that is there
};
// For a training, or with the model of another program, which is read into the run's folder.
// Errors: kUsage (unknown method or field, a run in the folder without `force`, another process at
// work there), kBadReference (the dataset); of models check_row_name()'s and import_model()'s.
SingleCell new_single_cell(const CommonOptions& common, const NewCellOptions& options);

// Nobody else writes into the folder while it lives. Errors (kUsage): somebody is at work there;
// `otherwise` says what to do but to wait.
FileLock lock_run(const fs::path& run, std::string_view otherwise = "choose another --run");

// The run of a folder that `train` or `all` filled, with its dataset loaded again; from `dataset`
// (a folder or packed scene) where that is given, since the data may have moved. Other data than
// the run was trained on come with a warning. Errors (kBadPrediction): no run; kBadReference: the
// data.
SingleCell open_single_cell(const std::string& run_folder, const std::string& dataset = "");

// --dataset of the verbs that open a run.
void add_moved_dataset_option(CLI::App& verb, std::string& dataset);

// The scene of a folder that no profile names: as it calls itself. Errors: load_scene()'s.
LoadedScene load_user_data(SceneSource& source, const fs::path& dataset);

// Where the records of a run lie: ROOT of ROOT/runs/SCENE/METHOD/SEED, else OUT/single.
fs::path records_folder(const CommonOptions& common, const RunSpec& spec);

// Does the folder have records, all of single runs?
bool holds_single_runs(const fs::path& folder);

}  // namespace glint
