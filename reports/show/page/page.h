// SPDX-License-Identifier: MIT
// report/index.html: the results of a profile as one page for people. It opens from file:// without
// a network; data lies beside it as scripts, pictures as PNG.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "reports/run/records/cell_filter.h"
#include "reports/run/records/run_folder.h"
#include "reports/show/tables/tables.h"

namespace glint {

struct PageOptions {
  fs::path folder;                 // OUT/PROFILE with records.jsonl and runs/
  std::string profile, out, data;  // as given to --profile, --out and --data, for the commands
  CellFilter filter;               // cells to show; empty: all
  bool single_file = false;        // everything inside index.html, no assets/ beside it
  std::size_t faces = 0;           // of each mesh at most; 0: kPageFaces, kSingleFileFaces
  std::function<Scene(const RunSpec&)> load;  // the data that a run was scored against
};

// Above this size a single file is slow to open; a warning says so.
inline constexpr std::size_t kLargePageBytes = 50'000'000;

std::size_t mesh_faces(const PageOptions& options);

// Writes FOLDER/report/index.html and, unless `single_file`, FOLDER/report/assets/ (made anew; what
// others put there stays, and is named in a warning). Absent renders, maps, meshes, logs and data
// are shown as missing; damaged ones too, with a warning. Progress and the size written go to
// standard error. Returns the path of index.html. Errors: those of read_records(), kEnvironment
// (disk).
fs::path write_page(const PageOptions& options, const std::vector<Table>& tables);

}  // namespace glint
