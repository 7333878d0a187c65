// SPDX-License-Identifier: MIT
#include "reports/verbs/result_tables.h"

#include <algorithm>

#include "reports/verbs/listing.h"

namespace glint {

namespace {

// A table with nothing but failures is shown, too: it says why.
bool has_failure(const Table& table) {
  for (const TableRow& row : table.rows)
    for (const TableCell& cell : row.cells)
      if (cell.status == CellStatus::kFailed) return true;
  return false;
}

void check_ids(
    const std::vector<std::string>& ids, const std::vector<TableDefinition>& definitions
) {
  std::string known;
  for (const TableDefinition& definition : definitions)
    known += (known.empty() ? "" : ", ") + definition.id;
  for (const std::string& id : ids)
    GLINT_CHECK(
        std::any_of(
            definitions.begin(),
            definitions.end(),
            [&](const TableDefinition& definition) { return definition.id == id; }
        ),
        kUsage,
        "no table '{}'; tables: {}",
        id,
        known
    );
}

}  // namespace

std::vector<Table> result_tables(const fs::path& folder, const std::vector<std::string>& ids) {
  const auto records = read_records(folder / "records.jsonl");
  const auto definitions = table_definitions();
  check_ids(ids, definitions);
  std::vector<Table> tables;
  for (const TableDefinition& definition : definitions)
    if (ids.empty() || std::find(ids.begin(), ids.end(), definition.id) != ids.end())
      tables.push_back(build_table(definition, records));
  return tables;
}

void write_tables(const fs::path& folder, const std::vector<Table>& tables) {
  for (const Table& table : tables) write_table(folder / "tables", table);
  write_file(folder / "tables" / "all.tex", latex_document(tables));
}

void print_tables(const std::vector<Table>& tables) {
  for (const Table& table : tables)
    print_text(
        has_measurement(table) || has_failure(table)
            ? table_terminal(table, {color_terminal(), terminal_width()}) + "\n"
            : fmt::format("{} ({}): nothing measured yet\n\n", table.title, table.id)
    );
}

}  // namespace glint
