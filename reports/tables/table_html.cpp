// SPDX-License-Identifier: MIT
#include "reports/records/script_text.h"
#include "reports/tables/table_writers.h"

namespace glint {

namespace {

constexpr std::string_view kStyle =
    "body{font:16px/1.5 system-ui,sans-serif;max-width:95rem;margin:2rem auto;padding:0 1rem;"
    "color:#111;background:#fff}\n"
    ".wide{overflow-x:auto}\n"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:1rem 0;"
    "border-top:2px solid;border-bottom:2px solid}\n"
    "th,td{padding:.2rem .6rem;text-align:right;white-space:nowrap}\n"
    "th:first-child,td:first-child{text-align:left}\n"
    "thead tr:last-child th{border-bottom:1px solid}\n"
    "tbody th{font-weight:normal}\n"
    "thead tr:first-child th{text-align:center}\n"
    ".others>*{border-top:1px "
    "solid}\n.published{color:#444}\n.none{color:#666;font-style:italic}\n";

std::string rank_styles() {
  std::string styles;
  for (int rank = 1; rank <= 3; ++rank) {
    const auto& shade = kRankShades[rank - 1];
    styles +=
        fmt::format(".rank{}{{background:rgb({},{},{})}}\n", rank, shade[0], shade[1], shade[2]);
  }
  return styles;
}

std::string group_row(const Table& table) {
  std::string row = "<tr><th></th>";
  for (std::size_t i = 0; i < table.columns.size();) {
    const TableColumn& column = table.columns[i];
    std::size_t end = i;
    while (end < table.columns.size() && table.columns[end].group == column.group &&
           table.columns[end].published == column.published)
      ++end;
    row += fmt::format(
        "<th colspan=\"{}\">{}{}</th>",
        end - i,
        html_text(column.group),
        column.published ? "† (published)" : ""
    );
    i = end;
  }
  return row + "</tr>\n";
}

std::string cell_html(const TableCell& cell, const TableColumn& column) {
  std::string classes = column.published ? "published" : "";
  if (cell.rank > 0) classes = fmt::format("rank{}", cell.rank);
  if (!cell.has_value()) classes = "none";
  const std::string interval = interval_text(cell, column);
  return fmt::format(
      "<td class=\"{}\" title=\"{}\">{}{}</td>",
      classes,
      html_text(cell.note),
      html_text(shown_text(cell, column)),
      interval.empty() ? "" : fmt::format("<br><small>{}</small>", html_text(interval))
  );
}

std::string table_element(const Table& table) {
  std::string html = "<div class=\"wide\"><table>\n<thead>\n" + group_row(table);
  html += "<tr><th scope=\"col\">Method</th>";
  for (const TableColumn& column : table.columns)
    html += fmt::format("<th scope=\"col\">{}</th>", html_text(shown_title(column)));
  html += "</tr>\n</thead>\n<tbody>\n";
  for (const TableRow& row : table.rows) {
    html += begins_others(table, row) ? "<tr class=\"others\">" : "<tr>";
    html += fmt::format("<th scope=\"row\">{}</th>", html_text(row.title));
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      html += cell_html(row.cells[i], table.columns[i]);
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

}  // namespace

std::string table_html(const Table& table) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{0}</title>\n"
      "<style>\n{1}{2}</style>\n<h1>{0}</h1>\n<p>{3}</p>\n",
      html_text(table.title),
      kStyle,
      rank_styles(),
      html_text(table.caption)
  );
  html += table_element(table);
  if (const Table differences = difference_table(table); !differences.rows.empty())
    html += fmt::format("<p>{}</p>\n{}", html_text(differences.title), table_element(differences));
  html += "<ul>\n";
  for (const std::string& note : table_notes(table))
    html += fmt::format("<li>{}</li>\n", html_text(note));
  return html + "</ul>\n</html>\n";
}

}  // namespace glint
