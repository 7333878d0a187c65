// SPDX-License-Identifier: MIT
// Files of reports/ that are compiled into the programs, by their path below reports/:
// "paper/glint.json", "tables/table1_photometric.toml", "profiles/ci.toml",
// "show/page/dist/report.js".
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/config.h"

namespace glint {

const std::map<std::string, std::string_view>& embedded_files();

// Stems of the embedded files of a folder, in alphabetical order: "profiles" -> {"ci", "paper",
// ...}.
std::vector<std::string> embedded_names(std::string_view folder);

// TOML text as JSON. Errors (kUsage): not TOML; the message opens with `where` and the line.
Json json_from_toml(std::string_view text, std::string_view where);

}  // namespace glint
