// SPDX-License-Identifier: MIT
#include "reports/verbs/result_tables.h"

#include <algorithm>

#include "glint/core/progress.h"

namespace glint {

namespace {

// A table with nothing but failures is shown, too: it says why.
bool has_failure(const Table& table) {
  for (const TableRow& row : table.rows)
    for (const TableCell& cell : row.cells)
      if (cell.status == CellStatus::kFailed) return true;
  return false;
}

}  // namespace

void check_table_ids(const std::vector<std::string>& ids) {
  std::vector<std::string> known;
  for (const TableDefinition& definition : table_definitions()) known.push_back(definition.id);
  for (const std::string& id : ids)
    GLINT_CHECK(
        std::find(known.begin(), known.end(), id) != known.end(),
        kUsage,
        "no table '{}'; tables: {}",
        id,
        fmt::join(known, ", ")
    );
}

std::vector<Table> result_tables(
    const fs::path& folder, const std::vector<std::string>& ids, const CellFilter& filter
) {
  check_table_ids(ids);
  const auto records = chosen_records(read_records(folder / "records.jsonl"), filter);
  std::vector<Table> tables;
  for (TableDefinition& definition : table_definitions()) {
    if (!ids.empty() && std::find(ids.begin(), ids.end(), definition.id) == ids.end()) continue;
    if (!filter.methods.empty()) definition.leave_out.clear();  // they were asked for
    if (!filter.empty()) keep_rows_with_records(definition, records);
    Table table = build_table(definition, records);
    if (ids.empty() && definition.where_measured && !has_measurement(table)) continue;
    tables.push_back(std::move(table));
  }
  return tables;
}

void write_tables(const fs::path& folder, const std::vector<Table>& tables) {
  for (const Table& table : tables) write_table(folder / "tables", table);
  write_file(folder / "tables" / "all.tex", latex_document(tables));
}

void print_tables(const std::vector<Table>& tables) {
  const std::size_t width = terminal_width();
  for (const Table& table : tables)
    print_raw(
        has_measurement(table) || has_failure(table)
            ? table_terminal(table, {color_terminal(), width, width == 0}) + "\n"
            : fmt::format("{} ({}): nothing measured yet\n\n", table.title, table.id)
    );
  if (width == 0) log::info("all columns and notes: --format md, or the files in tables/");
}

}  // namespace glint
