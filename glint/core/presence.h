// SPDX-License-Identifier: MIT
// Whether something is there. Only "there is no such file or folder" means absent: what cannot be
// looked up may well be there, and a mask or a truth that counts as not given makes wrong numbers.
#pragma once

#include <fstream>
#include <functional>

#include "glint/core/error.h"
#include "glint/core/files.h"
#include "glint/core/progress.h"

namespace glint {

enum class Presence { kAbsent, kFile, kFolder };

// Errors: (kEnvironment) it cannot be looked up for want of a permission; (kBadReference) it is a
// link that leads nowhere or to itself, or neither a file nor a folder (a pipe, a device, a
// socket), which would be waited for or read without end.
Presence presence_of(const fs::path& path);

// presence_of() in a word, with its errors.
bool is_there(const fs::path& path);
bool is_file(const fs::path& path);
bool is_folder(const fs::path& path);

// Whether the name itself is taken, by whatever: links are not followed. Errors: (kEnvironment) it
// cannot be looked up for want of a permission.
bool is_taken(const fs::path& path);

// Whether the name itself is a folder's and no link's: of what is moved or removed, and not read.
bool is_real_folder(const fs::path& path);

// What `look` finds, for housekeeping and for pages of many runs, which go on without: an error is
// a warning, and what could not be looked up counts as nothing.
template <class F>
auto or_warn(F&& look) -> decltype(look()) {
  try {
    return look();
  } catch (const Error& error) {
    log::warn(error.what());
    return decltype(look())();
  }
}

// All that is in a folder, hidden or not and whatever it is, by name; none where it is not there.
// Errors: those of presence_of(); (kBadReference) it is a file, or cannot be read; (kEnvironment)
// for want of a permission.
std::vector<fs::path> list_entries(const fs::path& folder);

// Folders in a folder, also behind links, by their names; none where it is not there. Errors: those
// of list_entries(), and of presence_of() for what is in it.
std::vector<fs::path> list_folders(const fs::path& folder);

enum class FolderLinks { kPassedOver, kFollowed };  // photos often lie behind one

// Files below a folder, sorted by their names below it. What `leaves_out` says yes to is not looked
// up. Errors: as list_folders(); (kBadReference) a link that is followed leads back to a folder
// around it.
std::vector<fs::path> list_files_below(
    const fs::path& folder,
    const std::function<bool(const fs::path& path)>& leaves_out = {},
    FolderLinks links = FolderLinks::kPassedOver
);

// To be read from its first byte. Errors: those of presence_of(); (kBadReference) it is missing or
// a folder; (kEnvironment) without permission.
std::ifstream open_file(const fs::path& path);

}  // namespace glint
