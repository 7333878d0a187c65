// SPDX-License-Identifier: MIT
#include "reports/show/tables/table_writers.h"

#include <algorithm>

#include "glint/core/printable.h"
#include "reports/show/tables/table_cells.h"

namespace glint {

namespace {

constexpr std::string_view kPublishedNote =
    "† published by the paper's authors, measured on their own data; not comparable digit by "
    "digit.";

std::string status_word(CellStatus status) {
  switch (status) {
    case CellStatus::kOk:
      return "ok";
    case CellStatus::kPartial:
      return "partial";
    case CellStatus::kMissing:
      return "missing";
    case CellStatus::kFailed:
      return "failed";
    case CellStatus::kUnavailable:
      return "unavailable";
    case CellStatus::kNotApplicable:
      return "not applicable";
  }
  return "missing";
}

// Stands in place of a value.
std::string word_of(const TableCell& cell) {
  return cell.status == CellStatus::kUnavailable ? cell.text : status_word(cell.status);
}

std::string group_title(const TableColumn& column) {
  return column.published ? column.group + "†" : column.group;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i)
    text += (i ? std::string(separator) : "") + parts[i];
  return text;
}

std::string csv_value(const TableCell& cell, const TableColumn& column) {
  const bool text = !column.field.empty();
  if (!cell.has_value()) return csv_field(word_of(cell));
  return csv_field(text || column.published ? cell.text : fmt::format("{:.10g}", cell.value));
}

Json cell_json(const TableCell& cell, const TableColumn& column) {
  Json json = Json::object();
  json["status"] = status_word(cell.status);
  if (cell.has_value()) {
    json["text"] = shown_text(cell, column);
    if (column.field.empty()) json["value"] = cell.value;
  }
  if (cell.num_seeds > 0) {
    json["n_scenes"] = cell.num_scenes;
    json["n_seeds"] = cell.num_seeds;
    json["spread"] = cell.spread;
    json["spread_kind"] = cell.num_seeds > 2 ? "std" : (cell.num_seeds == 2 ? "range" : "none");
  }
  if (cell.interval) json["interval"] = {cell.interval->low, cell.interval->high};
  if (cell.rank > 0) json["rank"] = cell.rank;
  if (cell.tied) json["tied_with_first"] = true;
  if (!cell.note.empty()) json["note"] = cell.note;
  return json;
}

Json column_json(const TableColumn& column) {
  const char* direction = column.order == RankOrder::kHigherFirst  ? "higher"
                          : column.order == RankOrder::kLowerFirst ? "lower"
                                                                   : "none";
  return {
      {"id", column.id},
      {"title", column.title},
      {"group", column.group},
      {"metric", column.metric},
      {"unit", column.unit},
      {"direction", direction},
      {"decimals", column.decimals},
      {"scale", column.scale},
      {"published", column.published}};
}

std::string markdown_rows(const Table& table) {
  std::vector<std::string> header{"Method"}, rule{"---"};
  for (const TableColumn& column : table.columns) {
    const std::string group = markdown_text(group_title(column));
    header.push_back(markdown_text(shown_title(column)) + (group.empty() ? "" : "<br>" + group));
    rule.push_back("---:");
  }
  std::string text = fmt::format("| {} |\n| {} |\n", join(header, " | "), join(rule, " | "));
  for (const TableRow& row : table.rows) {
    std::vector<std::string> cells{markdown_text(row.title)};
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const char* mark = row.cells[i].rank == 1 ? "**" : (row.cells[i].rank == 2 ? "_" : "");
      const std::string shown = markdown_text(shown_text(row.cells[i], table.columns[i]));
      const std::string interval = interval_text(row.cells[i], table.columns[i]);
      cells.push_back(fmt::format(
          "{0}{1}{0}{2}", mark, shown, interval.empty() ? "" : "<br>" + markdown_text(interval)
      ));
    }
    text += fmt::format("| {} |\n", join(cells, " | "));
  }
  return text;
}

}  // namespace

std::string markdown_text(std::string_view text) {
  std::string safe;
  for (const char c : printable(text))
    safe += c == '|' ? "\\|" : (c == '<' ? "&lt;" : (c == '\n' ? " " : std::string(1, c)));
  return safe;
}

std::string shown_text(const TableCell& cell, const TableColumn& column) {
  if (cell.status == CellStatus::kNotApplicable) return "–";
  if (!cell.has_value()) return word_of(cell);
  std::string text = cell.text;
  if (cell.num_seeds > 1) text += " ± " + format_value(cell.spread, column.decimals);
  if (cell.tied) text += "≈";
  return cell.status == CellStatus::kPartial ? text + "*" : text;
}

std::string interval_text(const TableCell& cell, const TableColumn& column) {
  if (!cell.interval) return "";
  return fmt::format(
      "[{}, {}]",
      format_value(cell.interval->low, column.decimals),
      format_value(cell.interval->high, column.decimals)
  );
}

std::string shown_title(const TableColumn& column) {
  std::string title = column.title;
  if (!column.unit.empty()) title += fmt::format(" ({})", column.unit);
  if (column.order != RankOrder::kNone) title += fmt::format(" {}", order_arrow(column.order));
  return title;
}

bool begins_others(const Table& table, const TableRow& row) {
  return !row.rival && &row != table.rows.data() && (&row - 1)->rival;
}

std::vector<std::string> table_notes(const Table& table) {
  std::vector<std::string> notes = table.notes;
  const bool published = std::any_of(
      table.columns.begin(), table.columns.end(), [](const TableColumn& c) { return c.published; }
  );
  if (published) notes.emplace_back(kPublishedNote);
  return notes;
}

std::string table_markdown(const Table& table) {
  std::string text = fmt::format("## {}\n\n{}\n\n", table.title, markdown_text(table.caption));
  text += markdown_rows(table);
  text += "\n";
  for (const std::string& note : table_notes(table))
    text += fmt::format("- {}\n", markdown_text(note));
  return text;
}

// Ids of the columns whose value is not ranked: it cannot be compared with the others'.
std::vector<std::string> partial_columns(const TableRow& row, const Table& table) {
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < row.cells.size(); ++i)
    if (row.cells[i].has_value() && (!row.rival || row.cells[i].status == CellStatus::kPartial))
      ids.push_back(table.columns[i].id);
  return ids;
}

std::string table_csv(const Table& table) {
  std::vector<std::string> header{"method"};
  for (const TableColumn& column : table.columns) header.push_back(csv_field(column.id));
  header.emplace_back("not_ranked");
  std::string text = join(header, ",") + "\n";
  for (const TableRow& row : table.rows) {
    std::vector<std::string> cells{csv_field(row.method)};
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      cells.push_back(csv_value(row.cells[i], table.columns[i]));
    cells.push_back(csv_field(join(partial_columns(row, table), "; ")));
    text += join(cells, ",") + "\n";
  }
  return text;
}

Json agreement_json(const OrderAgreement& order) {
  Json json = {
      {"column", order.column}, {"kendall_tau", order.tau}, {"n_methods", order.num_methods}};
  json["interval"] =
      order.interval ? Json{order.interval->low, order.interval->high} : Json(nullptr);
  json["random_orders_within"] = order.chance.high;
  return json;
}

Json table_json(const Table& table) {
  Json json = {{"id", table.id}, {"title", table.title}, {"caption", table.caption}};
  json["columns"] = Json::array();
  for (const TableColumn& column : table.columns) json["columns"].push_back(column_json(column));
  json["rows"] = Json::array();
  for (const TableRow& row : table.rows) {
    Json cells = Json::object();
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      cells[table.columns[i].id] = cell_json(row.cells[i], table.columns[i]);
    json["rows"].push_back(
        {{"method", row.method}, {"title", row.title}, {"cells", std::move(cells)}}
    );
    if (!row.rival) json["rows"].back()["rival"] = false;
  }
  json["order_agreement"] = Json::array();
  for (const OrderAgreement& order : table.agreement)
    json["order_agreement"].push_back(agreement_json(order));
  json["notes"] = table_notes(table);
  return json;
}

void write_table(const fs::path& folder, const Table& table) {
  write_file(folder / (table.id + ".md"), table_markdown(table));
  write_file(folder / (table.id + ".tex"), table_latex(table));
  write_file(folder / (table.id + ".csv"), table_csv(table));
  write_file(folder / (table.id + ".json"), table_json(table).dump(2) + "\n");
}

}  // namespace glint
