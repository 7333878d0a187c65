// SPDX-License-Identifier: MIT
// The tables of a profile's folder, for `all` and `table`.
#pragma once

#include <vector>

#include "reports/verbs/verb.h"

namespace glint {

// From FOLDER/records.jsonl. Empty `ids`: all. Errors (kUsage): an unknown id.
std::vector<Table> result_tables(const fs::path& folder, const std::vector<std::string>& ids = {});

// FOLDER/tables/*.{md,tex,csv,json,html} and all.tex, a LaTeX document with all of them.
void write_tables(const fs::path& folder, const std::vector<Table>& tables);

// Aligned text, shaded on a terminal and in blocks where it is narrow (COLUMNS). Tables in which
// nothing is measured are named in one line.
void print_tables(const std::vector<Table>& tables);

}  // namespace glint
