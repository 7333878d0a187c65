// SPDX-License-Identifier: MIT
// Definitions of tables by name, and their cells.
#pragma once

#include <stdexcept>

#include "reports/tables/tables.h"

namespace glint::test {

inline TableDefinition definition_of(const std::string& id) {
  for (const TableDefinition& definition : table_definitions())
    if (definition.id == id) return definition;
  throw std::runtime_error("no table " + id);
}

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
