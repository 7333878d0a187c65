// SPDX-License-Identifier: MIT
// Whether something is there. Only "there is no such file or folder" means absent: what cannot be
// looked up may well be there, and a mask or a truth that counts as not given makes wrong numbers.
#pragma once

#include <fstream>

#include "glint/core/files.h"

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

// Folders in a folder, also behind links, by their names; none where it is not there. Errors: those
// of presence_of(), of what is in it, too; (kBadReference) it cannot be read.
std::vector<fs::path> list_folders(const fs::path& folder);

// To be read from its first byte. Errors: those of presence_of(); (kBadReference) it is missing or
// a folder; (kEnvironment) without permission.
std::ifstream open_file(const fs::path& path);

}  // namespace glint
