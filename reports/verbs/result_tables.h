// SPDX-License-Identifier: MIT
// The tables of a profile's folder, for `all` and `table`.
#pragma once

#include <vector>

#include "reports/verbs/verb.h"

namespace glint {

// From those of FOLDER/records.jsonl that `filter` chooses; with one, rows without any are left
// out. Empty `ids`: all tables. Errors (kUsage): check_table_ids(), chosen_records().
std::vector<Table> result_tables(
    const fs::path& folder, const std::vector<std::string>& ids = {}, const CellFilter& filter = {}
);

// Errors (kUsage): an unknown id.
void check_table_ids(const std::vector<std::string>& ids);

// FOLDER/tables/*.{md,tex,csv,json,html} and all.tex, a LaTeX document with all of them.
void write_tables(const fs::path& folder, const std::vector<Table>& tables);

// Aligned text: shaded on a terminal and no wider than it (COLUMNS); brief where standard output is
// none. Tables in which nothing is measured are named in one line.
void print_tables(const std::vector<Table>& tables);

}  // namespace glint
