// SPDX-License-Identifier: MIT
// What a run folder holds before a new run begins there. Only what this program wrote is ever moved
// or removed; whatever else lies in the folder stays as it is.
#pragma once

#include <vector>

#include "glint/core/files.h"

namespace glint {

// In config.json of every run.
inline constexpr const char* kWrittenByField = "written_by";
inline constexpr const char* kWrittenBy = "glint-bench";

// In a run folder: the finished run whose place a new one is taking.
inline constexpr const char* kPreviousRun = "previous_run";

// Does config.json say that the folder is a run of ours?
bool is_our_run(const fs::path& folder);

// Runs of ours in a folder and in its folders, sorted; not what lies in the folder of a run. What
// cannot be looked up is named in a warning.
std::vector<fs::path> runs_below(const fs::path& folder);

// A run that has ended, or a checkpoint that one could go on from: more than a minute's work.
bool holds_work(const fs::path& folder);

// Errors (kUsage): the folder holds files, but no run of ours.
void check_run_folder(const fs::path& folder);

// What this program wrote into the folder of a run, files only, config.json last.
std::vector<fs::path> files_of_run(const fs::path& run);
// Removes them and the checkpoint, and the folder if nothing else is there; what others put beside
// the checkpoint is named in warnings. Errors (kEnvironment): they cannot be.
void remove_run(const fs::path& run);

// Makes room for a new run. A finished run is set aside in FOLDER/previous_run until drop(); one
// that never ended is removed.
class EarlierRun {
 public:
  // `goes_on`: a run that did not end stays, since the new one takes it up. Errors:
  // check_run_folder()'s; kEnvironment: files cannot be moved.
  explicit EarlierRun(const fs::path& folder, bool goes_on = false);
  // Without drop(): puts the finished run back if the new one has got nowhere (no log, no
  // checkpoint, no scores), else says where it lies. What cannot be put back is a warning. Folders
  // that were made for the new run and are empty are removed.
  ~EarlierRun();
  EarlierRun(const EarlierRun&) = delete;
  EarlierRun& operator=(const EarlierRun&) = delete;

  void drop();  // the new run has ended: the earlier one goes

 private:
  void put_back() const;  // errors: kEnvironment, files cannot be moved

  fs::path folder_, outermost_made_;  // outermost_made_ empty: the folder was there
  bool dropped_ = false;
};

// Removes the maps of the views below `renders` and the folders that are empty then.
void remove_renders(const fs::path& renders);

// Saves into a hidden folder first, so that what lies there half-way is never taken for a whole
// run, and moves the files into `folder`. Their names.
std::vector<std::string> save_in_place(
    const fs::path& folder, const std::function<void(const fs::path&)>& save
);

}  // namespace glint
