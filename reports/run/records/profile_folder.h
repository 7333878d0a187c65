// SPDX-License-Identifier: MIT
// What --out means, for every verb: results of a profile lie in OUT/PROFILE. The profile's folder
// itself is taken, too, and known by its records.
#pragma once

#include <string>

#include "glint/core/files.h"

namespace glint {

// OUT/PROFILE; OUT where that has records.jsonl and OUT/PROFILE has none.
fs::path profile_folder(const fs::path& out, const std::string& profile);

// The same for what adds to the folder. Errors (kUsage): OUT itself holds the records of other
// profiles only.
fs::path own_profile_folder(const fs::path& out, const std::string& profile);

// The same for what shows results, of a profile as --profile gives it: a name or a TOML file.
// Errors (kBadPrediction): no record is there; the message says what to run and which other
// profiles in OUT have some.
fs::path folder_with_records(const fs::path& out, const std::string& given_profile);

}  // namespace glint
