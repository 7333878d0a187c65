// SPDX-License-Identifier: MIT
// A folder that we wrote, replaced by one that was made beside it: whole or not at all, and without
// the files that others put there. A kill leaves the old one or the new one under the name, or, on
// file systems that cannot exchange two names, none and the old one aside until recover_folder().
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

// Names, relative to `old`, of what we wrote there; `fresh` is the folder that takes its place.
using OwnNames = std::function<std::set<std::string>(const fs::path& old, const fs::path& fresh)>;

// Everything below a folder that is no folder with something in it: files, links (not followed) and
// empty folders, as names relative to it ("a/b.png"). Errors (kEnvironment): a folder that cannot
// be read.
std::set<std::string> leaves_below(const fs::path& folder);

// `made`, a folder beside `folder`, takes its place; what `own` does not name moves along. The
// names of that. Errors (kUsage): something that is not ours has a name that `made` needs, nothing
// is changed then; (kEnvironment): cannot be written.
std::vector<std::string> replace_folder(
    const fs::path& made, const fs::path& folder, const OwnNames& own
);

// Ends what a killed replace_folder() began: the old folder comes back where no new one stands,
// else what is not ours moves over and the rest goes. Errors (kEnvironment): cannot be written.
void recover_folder(const fs::path& folder, const OwnNames& own);

}  // namespace glint
