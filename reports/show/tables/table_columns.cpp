// SPDX-License-Identifier: MIT
// Tables with fewer columns, for where all of them have no room.
#include <algorithm>

#include "reports/show/tables/table_writers.h"

namespace glint {

namespace {

template <class F>
Table with_columns(const Table& table, F&& keep) {
  Table result = table;
  result.columns.clear();
  for (TableRow& row : result.rows) row.cells.clear();
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (!keep(i)) continue;
    result.columns.push_back(table.columns[i]);
    for (std::size_t r = 0; r < table.rows.size(); ++r)
      result.rows[r].cells.push_back(table.rows[r].cells[i]);
  }
  return result;
}

}  // namespace

Table without_published(const Table& table) {
  Table result = with_columns(table, [&](std::size_t i) { return !table.columns[i].published; });
  result.agreement.clear();
  std::erase_if(result.notes, [](const std::string& note) {
    return note.starts_with("Kendall's tau");
  });
  return result;
}

Table without_empty_columns(const Table& table) {
  return with_columns(table, [&](std::size_t i) {
    return std::any_of(table.rows.begin(), table.rows.end(), [&](const TableRow& row) {
      return row.cells[i].has_value();
    });
  });
}

}  // namespace glint
