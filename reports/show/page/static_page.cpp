// SPDX-License-Identifier: MIT
#include "reports/show/page/static_page.h"

#include <algorithm>
#include <regex>

#include "glint/core/printable.h"
#include "reports/run/records/embedded.h"
#include "reports/run/records/script_text.h"
#include "reports/show/tables/table_writers.h"

namespace glint {
namespace {

// What the report's program does by buttons.
constexpr std::string_view kStyle =
    "section thead th{padding:.25rem .5rem;max-width:9rem;white-space:normal}"
    "section td,section tbody th{padding:.38rem .5rem}main>.notes{margin-bottom:.9rem}"
    "summary{cursor:pointer;font-weight:600}h1{font-size:1.4rem;margin:.2rem 0 .8rem}"
    "main>h2{font-size:1.25rem;margin:1.6rem 0 .6rem}svg{max-width:100%;height:auto}"
    "code{font-size:.9em}";

std::string group_title(const TableColumn& column) {
  return column.published ? column.group + ", published †" : column.group + ", measured";
}

// Groups over the columns, each as wide as it reaches.
std::string groups_html(const Table& table) {
  std::string html = "<tr class=\"groups\"><th></th>";
  for (std::size_t begin = 0, end = 0; begin < table.columns.size(); begin = end) {
    const std::string title = group_title(table.columns[begin]);
    while (end < table.columns.size() && group_title(table.columns[end]) == title) ++end;
    html +=
        fmt::format("<th colspan=\"{}\" scope=\"colgroup\">{}</th>", end - begin, page_text(title));
  }
  return html + "</tr>\n";
}

std::string heads_html(const Table& table) {
  std::string html = "<tr><th scope=\"col\">Method</th>";
  for (const TableColumn& column : table.columns)
    html += fmt::format("<th scope=\"col\">{}</th>", page_text(shown_title(column)));
  return html + "</tr>\n";
}

std::string rank_word(int rank) {
  constexpr const char* kWords[] = {"", "best", "second", "third"};
  return kWords[rank];
}

std::string hint_of(
    const TableRow& row, std::size_t i, const TableColumn& column, const CellHint& hint
) {
  const TableCell& cell = row.cells[i];
  std::vector<std::string> parts{rank_word(cell.rank), interval_text(cell, column), cell.note};
  if (cell.num_scenes > 0)
    parts.push_back(fmt::format("{} scenes, {} seeds", cell.num_scenes, cell.num_seeds));
  if (hint && cell.has_value() && !column.published) parts.push_back(hint(row, i));
  std::erase_if(parts, [](const std::string& part) { return part.empty(); });
  return fmt::format("{}", fmt::join(parts, " · "));
}

std::string classes_of(const TableCell& cell, const TableColumn& column) {
  std::string classes = "number";
  if (column.published) classes += " published";
  if (cell.rank > 0) classes += fmt::format(" rank-{}", cell.rank);
  if (!cell.has_value()) classes += " word";
  if (cell.status == CellStatus::kFailed) classes += " failed";
  return classes;
}

std::string cell_html(
    const TableRow& row, std::size_t i, const TableColumn& column, const CellHint& hint
) {
  const TableCell& cell = row.cells[i];
  return fmt::format(
      "<td class=\"{}\" title=\"{}\">{}{}</td>",
      classes_of(cell, column),
      page_text(hint_of(row, i, column, hint)),
      page_text(shown_text(cell, column)),
      column.published && cell.has_value() ? "†" : ""
  );
}

std::string row_html(const Table& table, const TableRow& row, const CellHint& hint) {
  std::string html = fmt::format("<tr><th scope=\"row\">{}</th>", page_text(row.title));
  for (std::size_t i = 0; i < row.cells.size(); ++i)
    html += cell_html(row, i, table.columns[i], hint);
  return html + "</tr>\n";
}

// "Empty columns: LPIPS (Alex) (no weights)."; empty: none is.
std::string empty_columns_note(const Table& table) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const auto has_value = [&](const TableRow& row) { return row.cells[i].has_value(); };
    if (std::any_of(table.rows.begin(), table.rows.end(), has_value)) continue;
    names.push_back(table.columns[i].title);
    for (const TableRow& row : table.rows)
      if (row.cells[i].status == CellStatus::kUnavailable) {
        names.back() += fmt::format(" ({})", row.cells[i].text);
        break;
      }
  }
  return names.empty() ? "" : fmt::format("Empty columns: {}.", fmt::join(names, ", "));
}

bool is_number(std::string_view text) {
  return text.find_first_not_of("0123456789.,+-±%≈*–() over") == std::string_view::npos;
}

}  // namespace

std::string page_text(std::string_view text) { return html_text(printable(text)); }

std::string static_page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>{1}{2}</style>\n</head>\n"
      "<body>\n<main>\n<h1>{0}</h1>\n{3}</main>\n</body>\n</html>\n",
      page_text(title),
      inline_text(embedded_files().at("show/page/dist/report.css")),
      kStyle,
      body
  );
}

std::string table_html(const Table& whole, const CellHint& hint) {
  const Table table = without_empty_columns(whole);
  std::string html = fmt::format("<section class=\"card\">\n<h2>{}</h2>\n", page_text(table.title));
  if (!table.caption.empty())
    html += fmt::format("<p class=\"caption\">{}</p>\n", page_text(table.caption));
  html += "<div class=\"table-scroll\"><table>\n<thead>\n";
  html += groups_html(table) + heads_html(table) + "</thead>\n<tbody>\n";
  for (const TableRow& row : table.rows) html += row_html(table, row, hint);
  html += "</tbody>\n</table></div>\n";
  std::vector<std::string> notes = table_notes(table);
  if (const std::string note = empty_columns_note(whole); !note.empty()) notes.push_back(note);
  for (std::string& note : notes) note = page_text(note);
  return html + list_html(notes) + "</section>\n";
}

std::string plain_table_html(
    const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows
) {
  std::string html = "<div class=\"table-scroll\"><table>\n<thead>\n<tr>";
  const auto is_words = [&](std::size_t i) {
    return std::any_of(rows.begin(), rows.end(), [&](const auto& row) {
      return !is_number(row[i]);
    });
  };
  std::vector<const char*> classes;
  for (std::size_t i = 0; i < head.size(); ++i) {
    classes.push_back(is_words(i) ? "text" : "number");
    html += fmt::format("<th scope=\"col\" class=\"{}\">{}</th>", classes[i], page_text(head[i]));
  }
  html += "</tr>\n</thead>\n<tbody>\n";
  for (const auto& row : rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      html += fmt::format("<td class=\"{}\">{}</td>", classes[i], page_text(row[i]));
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string list_html(const std::vector<std::string>& items) {
  if (items.empty()) return "";
  std::string html = "<ul class=\"notes\">\n";
  for (const std::string& item : items) html += fmt::format("<li>{}</li>\n", item);
  return html + "</ul>\n";
}

std::string inline_markdown_html(std::string_view markdown) {
  static const std::regex code("`([^`]*)`"), link(R"(\[([^\]]*)\]\(([^)\s]*)\))");
  const std::string html = page_text(markdown);
  return std::regex_replace(
      std::regex_replace(html, code, "<code>$1</code>"), link, "<a href=\"$2\">$1</a>"
  );
}

}  // namespace glint
