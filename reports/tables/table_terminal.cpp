// SPDX-License-Identifier: MIT
#include <algorithm>

#include "reports/tables/table_writers.h"

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

// Columns that stand beside each other, from `first` to one before `end`; 0 is the method's.
struct Block {
  std::size_t first, end;
};

std::size_t width_of(const Block& block, const std::vector<std::size_t>& widths) {
  std::size_t width = widths[0];
  for (std::size_t i = block.first; i < block.end; ++i) width += 2 + widths[i];
  return width;
}

// Groups of the table as blocks; published ones apart.
std::vector<Block> group_blocks(const Table& table) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const bool joins = i > 0 && table.columns[i].group == table.columns[i - 1].group &&
                       table.columns[i].published == table.columns[i - 1].published;
    if (!joins) blocks.push_back({i + 1, i + 1});
    blocks.back().end = i + 2;
  }
  return blocks;
}

// As few blocks as fit into the width: whole groups beside each other, measured and published ones
// not; a group that is too wide alone is split between columns.
std::vector<Block> blocks_of(
    const Table& table, const std::vector<std::size_t>& widths, std::size_t width
) {
  const Block all{1, table.columns.size() + 1};
  if (width == 0 || width_of(all, widths) <= width) return {all};
  std::vector<Block> blocks;
  const auto published = [&](const Block& block) {
    return table.columns[block.first - 1].published;
  };
  for (const Block& group : group_blocks(table)) {
    if (!blocks.empty() && published(blocks.back()) == published(group) &&
        width_of({blocks.back().first, group.end}, widths) <= width) {
      blocks.back().end = group.end;
      continue;
    }
    blocks.push_back({group.first, group.first + 1});
    for (std::size_t i = group.first + 1; i < group.end; ++i)
      if (width_of({blocks.back().first, i + 1}, widths) <= width)
        blocks.back().end = i + 1;
      else
        blocks.push_back({i, i + 1});
  }
  return blocks;
}

std::string block_text(
    const Table& table,
    const std::vector<std::vector<std::string>>& rows,
    const Block& block,
    bool color
) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += padded(rows[r][0], widths[0], true);
    for (std::size_t i = block.first; i < block.end; ++i) {
      const int rank = r >= 2 ? table.rows[r - 2].cells[i - 1].rank : 0;
      const std::string cell = padded(rows[r][i], widths[i], false);
      text += "  ";
      text += color && rank > 0 ? shaded(cell, rank) : cell;
    }
    text += "\n";
  }
  return text;
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

std::string table_terminal(const Table& table, TerminalStyle style) {
  const auto rows = texts_of(table);
  std::string text = table.title + "\n";
  const auto blocks = blocks_of(table, widths_of(rows), style.width);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (i > 0) text += "\n";
    text += block_text(table, rows, blocks[i], style.color);
  }
  for (const std::string& note : table_notes(table)) text += "  " + note + "\n";
  return text;
}

}  // namespace glint
