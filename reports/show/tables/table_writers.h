// SPDX-License-Identifier: MIT
// A Table in each format. Cells without a value are words, never zeros or blanks; published
// columns carry a dagger, values that are not ranked an asterisk.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "reports/show/tables/tables.h"

namespace glint {

// What a reader sees in a cell: "31.24", "31.24 ± 0.10" (several seeds), "31.24*", "missing".
std::string shown_text(const TableCell& cell, const TableColumn& column);
// Behind it: "[30.1, 32.4]"; empty: the cell has no interval.
std::string interval_text(const TableCell& cell, const TableColumn& column);
std::string shown_title(const TableColumn& column);  // "RMSE (m) ↓"

// Is it the first row below the rivals, where a rule stands?
bool begins_others(const Table& table, const TableRow& row);

// The table's notes and what its marks mean, a line each.
std::vector<std::string> table_notes(const Table& table);

std::string table_markdown(const Table& table);  // best in bold, second in italics
// A tabular to \input, best in bold, second underlined: needs booktabs and xcolor with its option
// `table`.
std::string table_latex(const Table& table);
// Method id first, then column ids; unrounded values, or the status word. Last the ids of columns
// whose value has an asterisk in the other formats.
std::string table_csv(const Table& table);
Json table_json(const Table& table);

// Measured columns only, without what is said of the published ones.
Table without_published(const Table& table);
// Columns in which a method has a value, measured or published.
Table without_empty_columns(const Table& table);

struct TerminalStyle {
  bool color = false;
  std::size_t width = 0;  // columns of the terminal; 0: no limit
  bool brief = false;     // rows and measured columns with values, notes on means and marks
};
// What is too wide for the terminal comes in blocks below each other, each with the methods.
std::string table_terminal(const Table& table, TerminalStyle style = {});

// A LaTeX document with FOLDER/<id>.tex of all tables: booktabs, xcolor and graphicx.
std::string latex_document(const std::vector<Table>& tables);

// FOLDER/<id>.md, .tex, .csv, .json
void write_table(const fs::path& folder, const Table& table);

// Text inside a cell of a Markdown table: pipes and tags stay letters.
std::string markdown_text(std::string_view text);

}  // namespace glint
