// SPDX-License-Identifier: MIT
// Which code computes what, as this program was built; the values are written at build time
// (reports/run/code). Comments and blanks do not count.
#pragma once

#include <map>
#include <string>

#include "glint/core/config.h"

namespace glint {

using CodeHashes = std::map<std::string, std::string>;  // source file -> hash of its code

// By what it is for: the entries of reports/run/code/stage_sources.h and each file that registers a
// method or a loader.
const std::map<std::string, CodeHashes>& code_hashes();

// {"glint/render/blend.h": "1a2b...", ...}: the code of several entries. Errors (kEnvironment): no
// such entry.
Json code_json(const std::vector<std::string>& entries);

// The entry of a file that registers something, as the compiler calls it ("/x/baselines/2dgs.cpp").
// Empty: registered without a file. Errors (kEnvironment): a file that the build did not hash.
std::string code_entry_of(const std::string& source);

}  // namespace glint
