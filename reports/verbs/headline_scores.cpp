// SPDX-License-Identifier: MIT
#include "reports/verbs/headline_scores.h"

#include <fmt/format.h>

#include <algorithm>

#include "glint/core/rows.h"
#include "metrics/metric.h"
#include "reports/show/tables/table_cells.h"

namespace glint {

namespace {

constexpr std::size_t kHeadlines = 10;
constexpr const char* kHeadlineTable = "summary";

std::vector<TableColumn> headline_columns() {
  for (const TableDefinition& table : table_definitions())
    if (table.id == kHeadlineTable) {
      const std::size_t count = std::min(kHeadlines, table.columns.size());
      return {table.columns.begin(), table.columns.begin() + static_cast<std::ptrdiff_t>(count)};
    }
  return {};
}

// Costs are no metrics of pictures or meshes.
std::string unit_of(const std::string& id) {
  if (const Metric* metric = find_metric(id)) return metric->unit;
  if (id == "train-minutes") return "min";
  if (id == "peak-memory" || id == "device-memory") return "MB";
  return id == "fps" ? "frames/s" : "";
}

}  // namespace

std::string headline_scores(const std::map<std::string, double>& means) {
  Rows rows({{""}, {"", "", "{}"}, {""}, {""}});
  for (const TableColumn& column : headline_columns()) {
    auto found = means.find(column.metric);
    const bool exact = found != means.end();
    if (!exact) found = means.find(eight_bit_metric(column.metric));
    const bool eight_bit = !exact && found != means.end();
    const std::string value =
        found == means.end() ? "-" : format_value(column.scale * found->second, column.decimals);
    const bool higher = column.order == RankOrder::kHigherFirst;
    rows.add(
        {column.title + (eight_bit ? " of 8-bit images" : ""),
         value,
         column.unit,
         higher ? "higher is better" : "lower is better"}
    );
  }
  return rows.text();
}

std::string all_scores(const std::map<std::string, double>& means) {
  Rows rows({{""}, {"", "", "{:.4f}"}, {""}});
  for (const auto& [id, value] : means) rows.add({id, value, unit_of(id)});
  return rows.text();
}

}  // namespace glint
