// SPDX-License-Identifier: MIT
// What long work takes for granted of a machine: folders that keep what is written, a clock, files
// that can be opened.
#pragma once

#include <ctime>

#include "glint/core/files.h"
#include "reports/run/provenance/checked.h"

namespace glint {

// Can files be written there (or in the nearest folder above that is there), brought to the disk
// and locked against other processes? Leaves nothing behind. `option`: the one that names another.
Checked examine_folder(const std::string& name, const fs::path& folder, const std::string& option);

// Times in records and locks are the machine's; before `built` (0: not known) they are wrong.
Checked examine_clock(std::time_t now, std::time_t built);

// How many files one process may have open.
Checked examine_open_files();

}  // namespace glint
