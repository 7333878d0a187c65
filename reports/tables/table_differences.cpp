// SPDX-License-Identifier: MIT
#include <algorithm>

#include "reports/tables/table_writers.h"

namespace glint {

namespace {

struct ColumnPair {
  std::size_t measured, published;
};

// Measured columns of the table's own dataset with their first published counterpart.
std::vector<ColumnPair> pairs_of(const Table& table) {
  std::vector<ColumnPair> pairs;
  const std::vector<TableColumn>& columns = table.columns;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].published || columns[i].paper_column.empty()) continue;
    if (columns[i].dataset != columns.front().dataset) continue;
    const auto it = std::find_if(columns.begin(), columns.end(), [&](const TableColumn& other) {
      return other.published && other.paper_column == columns[i].paper_column;
    });
    if (it != columns.end()) pairs.push_back({i, static_cast<std::size_t>(it - columns.begin())});
  }
  return pairs;
}

TableCell difference_cell(
    const TableCell& measured, const TableCell& published, const TableColumn& column
) {
  TableCell cell;
  cell.status = CellStatus::kNotApplicable;
  if (!measured.has_value() || !published.has_value()) return cell;
  cell.status = measured.status;
  cell.value = measured.value - published.value;
  cell.text = fmt::format("{:+.{}f}", cell.value, column.decimals);
  return cell;
}

}  // namespace

Table difference_table(const Table& table) {
  Table differences;
  differences.id = table.id + "_differences";
  const auto pairs = pairs_of(table);
  for (const auto& [measured, published] : pairs) {
    TableColumn column = table.columns[measured];
    column.id = "difference/" + column.id;
    column.group = fmt::format("{} - {}†", column.group, table.columns[published].group);
    differences.title = fmt::format(
        "Measured minus published ({}†); the data are not the same.", table.columns[published].group
    );
    differences.columns.push_back(column);
  }
  for (const TableRow& row : table.rows) {
    TableRow result{row.method, row.title, row.paper_row, {}};
    for (const auto& [measured, published] : pairs)
      result.cells.push_back(
          difference_cell(row.cells[measured], row.cells[published], table.columns[measured])
      );
    if (std::any_of(result.cells.begin(), result.cells.end(), [](const TableCell& cell) {
          return cell.has_value();
        }))
      differences.rows.push_back(std::move(result));
  }
  return differences;
}

}  // namespace glint
