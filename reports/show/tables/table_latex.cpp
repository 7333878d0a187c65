// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "reports/show/tables/table_writers.h"

namespace glint {

namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 22> kLatexForms{{
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
    {"‡", "$^\\ddagger$"},
    {"↑", "$\\uparrow$"},
    {"↓", "$\\downarrow$"},
    {"≈", "$^\\approx$"},
    {"–", "--"},
    {"^", "\\textasciicircum{}"},
    {"|", "$|$"},
}};

// Printable: what pdfTeX prints without further packages.
bool is_ascii(char c) { return c >= ' ' && c <= '~'; }
bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; }

// A sign or an operator, not a hyphen: behind a space or first, before a digit or a space.
bool is_minus(std::string_view text, const std::string& before) {
  return text.size() > 1 && text[0] == '-' && (before.empty() || before.back() == ' ') &&
         (text[1] == ' ' || (text[1] >= '0' && text[1] <= '9'));
}

std::string latex_text(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    std::string_view form = is_ascii(text[0]) ? text.substr(0, 1) : "?";
    if (is_minus(text, result)) form = "$-$";
    std::size_t length = 1;
    while (!is_ascii(text[0]) && length < text.size() && is_continuation(text[length])) ++length;
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

// For a comment, which a line feed or a carriage return ends.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' '
  );
  return text;
}

std::string latex_value(const TableCell& cell, const TableColumn& column) {
  const std::string text =
      cell.status == CellStatus::kNotApplicable ? "--" : latex_text(shown_text(cell, column));
  if (cell.rank < 1) return text;
  // Shades are lost in black and white: the first is bold, the second underlined, too.
  const char* form = cell.rank == 1 ? "\\textbf" : "\\underline";
  const std::string marked = cell.rank < 3 ? fmt::format("{}{{{}}}", form, text) : text;
  const auto& shade = kRankShades[cell.rank - 1];
  return fmt::format("\\cellcolor[RGB]{{{},{},{}}}{}", shade[0], shade[1], shade[2], marked);
}

std::string latex_cell(const TableCell& cell, const TableColumn& column) {
  const std::string interval = interval_text(cell, column);
  return latex_value(cell, column) +
         (interval.empty() ? "" : fmt::format(" {{\\scriptsize {}}}", latex_text(interval)));
}

struct ColumnGroup {
  std::string title;
  std::size_t first = 0, count = 0;  // columns behind the method's
};

bool is_difference(const TableColumn& column) { return column.id.rfind("difference/", 0) == 0; }

std::vector<ColumnGroup> groups_of(const Table& table) {
  std::vector<ColumnGroup> groups;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const TableColumn& column = table.columns[i];
    const std::string title = column.published
                                  ? column.group + "† (published)"
                                  : column.group + (is_difference(column) ? "" : " (measured)");
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
  std::string text = fmt::format("% {} {}\n", one_line(table.title), one_line(table.caption));
  text += "% \\usepackage{booktabs}\n% \\usepackage[table]{xcolor}\n";
  text += fmt::format("\\begin{{tabular}}{{l{}}}\n", std::string(table.columns.size(), 'c'));
  text += "\\toprule\n" + latex_header(table) + "\\midrule\n";
  for (const TableRow& row : table.rows) {
    if (begins_others(table, row)) text += "\\midrule\n";
    text += latex_text(row.title);
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      text += " & " + latex_cell(row.cells[i], table.columns[i]);
    text += " \\\\\n";
  }
  text += "\\bottomrule\n\\end{tabular}\n";
  for (const std::string& note : table.notes) text += "% " + one_line(note) + "\n";
  return text;
}

std::string latex_document(const std::vector<Table>& tables) {
  std::string text =
      "\\documentclass{article}\n\\usepackage[T1]{fontenc}\n"
      "\\IfFileExists{lmodern.sty}{\\usepackage{lmodern}}{}\n"  // else letters are pixels in T1
      "\\usepackage[a4paper,landscape,margin=15mm]{geometry}\n"
      "\\usepackage{booktabs,graphicx}\n\\usepackage[table]{xcolor}\n"
      "\\newcommand{\\fitted}[1]{\\resizebox{\\ifdim\\width>"
      "\\linewidth\\linewidth\\else\\width\\fi}"
      "{!}{\\input{#1}}}\n\\setlength{\\parindent}{0pt}\n\\begin{document}\n";
  for (const Table& table : tables) {
    text += fmt::format("\n\\section*{{{}}}\n", latex_text(table.title));
    text += fmt::format("{}\n\n\\medskip\n\\fitted{{{}}}\n", latex_text(table.caption), table.id);
    text += "\n\\medskip\n{\\footnotesize\n";
    for (const std::string& note : table_notes(table)) text += latex_text(note) + "\\par\n";
    text += "}\\bigskip\\filbreak\n";  // a new page where the next table would not fit
  }
  return text + "\\end{document}\n";
}

}  // namespace glint
