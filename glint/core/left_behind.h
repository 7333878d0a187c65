// SPDX-License-Identifier: MIT
// Hidden files and folders that are filled and then renamed: their names say who writes them, so
// that what a killed process left can be told from what another one is writing.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

// Absolute, without a separator at its end: names beside it are made of its own.
fs::path absolute_folder(const fs::path& folder);

// ".NAME.PID-HOST.part.EXT" beside `path`, for this process. The extension stays last: image
// writers choose the format by it.
fs::path unfinished_path(const fs::path& path);

// Unfinished files and folders in `folder` (and below it, where `recursive`) whose process has
// ended: of this machine when no process has the number any more, of others after a day. A folder
// that cannot be read is a warning.
std::vector<fs::path> list_left_behind(const fs::path& folder, bool recursive = true);

// Removes them; what cannot be removed stays without a word.
void remove_left_behind(const fs::path& folder, bool recursive = true);

// ".NAME.PID-HOST.old" beside a folder: where the one that it replaces waits to be removed.
fs::path aside_path(const fs::path& folder);

// Those of `folder`, which is absolute, whose process has ended. Errors: as list_entries().
std::vector<fs::path> list_aside(const fs::path& folder);

// A folder beside the one it will become, made anew; at its end, what was not moved out of it goes.
// So does what ended processes left there. Errors (kEnvironment): cannot be created.
class UnfinishedFolder {
 public:
  explicit UnfinishedFolder(const fs::path& final_path);
  ~UnfinishedFolder();
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace glint
