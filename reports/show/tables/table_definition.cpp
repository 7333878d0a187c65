// SPDX-License-Identifier: MIT
#include <algorithm>

#include "reports/run/records/embedded.h"
#include "reports/show/tables/tables.h"

namespace glint {

namespace {

RankOrder rank_order_of(const std::string& name, const std::string& where) {
  if (name == "higher") return RankOrder::kHigherFirst;
  if (name == "lower") return RankOrder::kLowerFirst;
  GLINT_CHECK(
      name == "none", kUsage, "{}: direction is '{}', expected higher, lower or none", where, name
  );
  return RankOrder::kNone;
}

// The keys of the three kinds of TOML tables; config_from_json reports unknown ones.
struct ColumnKeys {
  TableColumn column;
  std::string direction = "none";
  template <class V>
  void visit(V&& v) {
    v("title", column.title, "as printed");
    v("metric", column.metric, "metric id");
    v("field", column.field, "text column: device or resolution");
    v("unit", column.unit, "unit of the shown value");
    v("direction", direction, "higher, lower or none");
    v("decimals", column.decimals, "digits behind the point");
    v("scale", column.scale, "shown = scale x measured");
    v("where_measured", column.where_measured, "only where a record has it");
    v("paper_column", column.paper_column, "column in the paper's table");
    v("paper_title", column.paper_title, "its title; empty: the same");
  }
};

struct RowKeys {
  TableRowDefinition row;
  template <class V>
  void visit(V&& v) {
    v("method", row.method, "method id");
    v("title", row.title, "as printed");
    v("paper_row", row.paper_row, "row in the paper's table");
  }
};

struct TableKeys {
  TableDefinition table;
  Json rows = Json::array(), columns = Json::array();
  template <class V>
  void visit(V&& v) {
    v("title", table.title, "heading");
    v("caption", table.caption, "what is shown, on which data");
    v("dataset", table.dataset, "dataset whose records count");
    v("dataset_title", table.dataset_title, "its name as printed");
    v("paper_table", table.paper_table, "number of the paper's table");
    v("paper_datasets", table.paper_datasets, "published column groups");
    v("where_measured", table.where_measured, "only where a record has one of its columns");
    v("leave_out", table.leave_out, "globs of methods that other tables show; all others have rows"
    );
    v("rows", rows, "methods");
    v("columns", columns, "metrics");
  }
};

TableColumn parse_column(const Json& json, const std::string& where) {
  ColumnKeys keys;
  config_from_json(keys, json, where + " columns");
  keys.column.order = rank_order_of(keys.direction, where);
  keys.column.id = keys.column.metric.empty() ? keys.column.field : keys.column.metric;
  GLINT_CHECK(
      !keys.column.id.empty(), kUsage, "{}: column '{}' has no metric", where, keys.column.title
  );
  return keys.column;
}

}  // namespace

TableDefinition parse_table_definition(std::string_view toml, const std::string& id) {
  const std::string where = fmt::format("tables/{}.toml", id);
  TableKeys keys;
  config_from_json(keys, json_from_toml(toml, where), where);
  keys.table.id = id;
  for (const Json& json : keys.rows) {
    RowKeys row;
    config_from_json(row, json, where + " rows");
    keys.table.rows.push_back(row.row);
  }
  for (const Json& json : keys.columns) {
    TableColumn column = parse_column(json, where);
    column.dataset = keys.table.dataset;
    column.group = keys.table.dataset_title;
    keys.table.columns.push_back(column);
  }
  return keys.table;
}

std::vector<TableDefinition> table_definitions() {
  // The paper's tables in its order, then the ones beyond it.
  std::vector<TableDefinition> definitions;
  for (const std::string& id : embedded_names("tables"))
    definitions.push_back(
        parse_table_definition(embedded_files().at(fmt::format("tables/{}.toml", id)), id)
    );
  std::stable_partition(definitions.begin(), definitions.end(), [](const TableDefinition& table) {
    return !table.paper_table.empty();
  });
  return definitions;
}

TableDefinition table_definition(const std::string& id) {
  for (TableDefinition& definition : table_definitions())
    if (definition.id == id) return std::move(definition);
  throw Error(ExitCode::kUsage, fmt::format("no table '{}'", id));
}

}  // namespace glint
