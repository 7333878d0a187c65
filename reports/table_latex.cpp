// SPDX-License-Identifier: MIT
#include <array>
#include <string_view>
#include <utility>

#include "reports/table_writers.h"

namespace glint {

namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 17> kLatexForms{{
    {"\\", "\\textbackslash{}"},
    {"&", "\\&"},
    {"%", "\\%"},
    {"$", "\\$"},
    {"#", "\\#"},
    {"_", "\\_"},
    {"{", "\\{"},
    {"}", "\\}"},
    {"<", "$<$"},
    {">", "$>$"},
    {"~", "$\\sim$"},
    {"δ", "$\\delta$"},
    {"°", "$^\\circ$"},
    {"±", "$\\pm$"},
    {"†", "$^\\dagger$"},
    {"↑", "$\\uparrow$"},
    {"↓", "$\\downarrow$"},
}};

std::string latex_text(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    std::string_view form = text.substr(0, 1);
    std::size_t length = 1;
    for (const auto& [plain, latex] : kLatexForms)
      if (text.substr(0, plain.size()) == plain) {
        form = latex;
        length = plain.size();
      }
    result += form;
    text.remove_prefix(length);
  }
  return result;
}

std::string latex_cell(const TableCell& cell, const TableColumn& column) {
  const std::string text =
      cell.status == CellStatus::kNotApplicable ? "--" : latex_text(shown_text(cell, column));
  if (cell.rank < 1) return text;
  const auto& shade = kRankShades[cell.rank - 1];
  return fmt::format("\\cellcolor[RGB]{{{},{},{}}}{}", shade[0], shade[1], shade[2], text);
}

struct ColumnGroup {
  std::string title;
  std::size_t first = 0, count = 0;  // columns behind the method's
};

std::vector<ColumnGroup> groups_of(const Table& table) {
  std::vector<ColumnGroup> groups;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const TableColumn& column = table.columns[i];
    const std::string title =
        column.published ? column.group + "† (published)" : column.group + " (measured)";
    if (groups.empty() || groups.back().title != title) groups.push_back({title, i, 0});
    ++groups.back().count;
  }
  return groups;
}

std::string latex_header(const Table& table) {
  std::string titles, rules, columns = "Method";
  for (const ColumnGroup& group : groups_of(table)) {
    titles +=
        fmt::format(" & \\multicolumn{{{}}}{{c}}{{{}}}", group.count, latex_text(group.title));
    // The method's column is LaTeX's column 1.
    rules += fmt::format("\\cmidrule(lr){{{}-{}}}", group.first + 2, group.first + group.count + 1);
  }
  for (const TableColumn& column : table.columns)
    columns += " & " + latex_text(shown_title(column));
  return fmt::format("{} \\\\\n{}\n{} \\\\\n", titles, rules, columns);
}

}  // namespace

std::string table_latex(const Table& table) {
  std::string text = fmt::format("% {}: {}\n", table.title, table.caption);
  text += "% \\usepackage{booktabs}\n% \\usepackage[table]{xcolor}\n";
  text += fmt::format("\\begin{{tabular}}{{l{}}}\n", std::string(table.columns.size(), 'c'));
  text += "\\toprule\n" + latex_header(table) + "\\midrule\n";
  for (const TableRow& row : table.rows) {
    text += latex_text(row.title);
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      text += " & " + latex_cell(row.cells[i], table.columns[i]);
    text += " \\\\\n";
  }
  text += "\\bottomrule\n\\end{tabular}\n";
  for (const std::string& note : table.notes) text += "% " + note + "\n";
  return text;
}

}  // namespace glint
