// SPDX-License-Identifier: MIT
// The page of a profile's folder, for `all` and `report`.
#pragma once

#include "reports/show/page/page.h"
#include "reports/verbs/verb.h"

namespace glint {

// Of the profile, as profile_folder.h says. Errors: as there, and an unknown profile.
fs::path folder_with_records(const CommonOptions& common);

// The data that a run was scored against. Errors (kBadReference): not there, damaged.
Scene load_run_data(const RunSpec& spec);

struct PageForm {
  bool single_file = false;
  std::size_t faces = 0;  // of each mesh at most; 0: as PageOptions
};

// FOLDER/report/index.html; returns its path. Errors: as write_page.
fs::path write_report(
    const CommonOptions& common,
    const fs::path& folder,
    const std::vector<Table>& tables,
    const PageForm& form = {}
);

}  // namespace glint
