// SPDX-License-Identifier: MIT
// Records, definitions of tables by name, and their cells.
#pragma once

#include <stdexcept>

#include "reports/show/tables/tables.h"

namespace glint::test {

// Of a cell of GlassRoom that ran.
inline Record record_of(const CellKey& cell, std::map<std::string, double> metrics) {
  Record record;
  record.dataset = "glassroom";
  record.cell = cell;
  record.metrics = std::move(metrics);
  return record;
}
// In the first room, with its PSNR.
inline Record record_of(const std::string& method, double psnr, std::uint64_t seed = 0) {
  return record_of({"room_1", method, seed}, {{"psnr", psnr}});
}

inline TableDefinition definition_of(const std::string& id) { return table_definition(id); }

inline const TableCell& cell_of(
    const Table& table, const std::string& method, const std::string& column
) {
  for (const TableRow& row : table.rows)
    if (row.method == method)
      for (std::size_t i = 0; i < table.columns.size(); ++i)
        if (table.columns[i].id == column) return row.cells[i];
  throw std::runtime_error("no cell " + method + " " + column);
}

}  // namespace glint::test
