// SPDX-License-Identifier: MIT
#include <algorithm>

#include "reports/table_writers.h"

namespace glint {

namespace {

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string space(width - std::min(width, text_width(text)), ' ');
  return left ? text + space : space + text;
}

std::vector<std::size_t> widths_of(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i >= widths.size()) widths.push_back(0);
      widths[i] = std::max(widths[i], text_width(row[i]));
    }
  return widths;
}

// Black on the paper's shade, by 24-bit ANSI codes.
std::string shaded(const std::string& text, int rank) {
  const auto& shade = kRankShades[rank - 1];
  return fmt::format("\x1b[30;48;2;{};{};{}m{}\x1b[0m", shade[0], shade[1], shade[2], text);
}

std::vector<std::vector<std::string>> texts_of(const Table& table) {
  std::vector<std::vector<std::string>> rows(2);
  rows[0].push_back("");
  rows[1].push_back("Method");
  for (const TableColumn& column : table.columns) {
    rows[0].push_back(column.published ? column.group + "†" : column.group);
    rows[1].push_back(shown_title(column));
  }
  for (const TableRow& row : table.rows) {
    rows.push_back({row.title});
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      rows.back().push_back(shown_text(row.cells[i], table.columns[i]));
  }
  return rows;
}

}  // namespace

std::size_t text_width(std::string_view utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u;  // not a continuation byte
  }));
}

std::string aligned_rows(const std::vector<std::vector<std::string>>& rows) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i)
      line += (i ? "  " : "") + padded(row[i], widths[i], i == 0);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string table_terminal(const Table& table, bool color) {
  const auto rows = texts_of(table);
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text = table.title + "\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      const int rank = r >= 2 && i > 0 ? table.rows[r - 2].cells[i - 1].rank : 0;
      const std::string cell = padded(rows[r][i], widths[i], i == 0);
      text += (i ? "  " : "") + (color && rank > 0 ? shaded(cell, rank) : cell);
    }
    text += "\n";
  }
  for (const std::string& note : table_notes(table)) text += "  " + note + "\n";
  return text;
}

}  // namespace glint
