// SPDX-License-Identifier: MIT
// What a profile's folder holds that belongs to no finished cell: `glint-bench status --leftovers`.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

struct Leftover {
  fs::path path;
  std::string why;  // "the process that wrote it has ended"
  std::uintmax_t bytes = 0;
  bool is_run = false;  // a run folder, of which only files of ours count and go
};

// unfinished: also trainings that the same command would go on with, and runs of failed cells.
// Runs in which another process is at work are not among them, nor what others wrote.
std::vector<Leftover> find_leftovers(const fs::path& folder, bool unfinished);

// Errors (kEnvironment): it cannot be removed.
void remove_leftover(const Leftover& leftover);

}  // namespace glint
