// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/printable.h"
#include "glint/core/rows.h"
#include "reports/show/tables/table_writers.h"

namespace glint {

namespace {

constexpr std::size_t kNumHeaders = 2;  // lines of groups and of titles

using Lines = std::vector<std::vector<std::string>>;

// Black on the paper's shade, by 24-bit ANSI codes.
std::string shaded(const std::string& text, int rank) {
  const auto& shade = kRankShades[rank - 1];
  return fmt::format("\x1b[30;48;2;{};{};{}m{}\x1b[0m", shade[0], shade[1], shade[2], text);
}

std::vector<std::string> row_texts(const Table& table, const TableRow& row) {
  std::vector<std::string> texts{row.title};
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    const std::string interval = interval_text(row.cells[i], table.columns[i]);
    texts.push_back(
        shown_text(row.cells[i], table.columns[i]) + (interval.empty() ? "" : " ") + interval
    );
  }
  return texts;
}

Table without_intervals(Table table) {
  for (TableRow& row : table.rows)
    for (TableCell& cell : row.cells) cell.interval.reset();
  std::erase_if(table.notes, [](const std::string& note) {
    return note.starts_with(kIntervalNote);
  });
  return table;
}

// Names from files are in all texts. Escapes are put in later, for colours.
Table printable_table(Table table) {
  std::vector<std::string*> texts{&table.title};
  for (TableColumn& column : table.columns)
    texts.insert(texts.end(), {&column.title, &column.group});
  for (TableRow& row : table.rows) {
    texts.push_back(&row.title);
    for (TableCell& cell : row.cells) texts.insert(texts.end(), {&cell.text, &cell.note});
  }
  for (std::string& note : table.notes) texts.push_back(&note);
  for (std::string* text : texts) *text = printable(*text);
  return table;
}

Lines lines_of(const Table& table) {
  Lines lines{{""}, {"Method"}};
  for (const TableColumn& column : table.columns) {
    lines[0].push_back(column.published ? column.group + "†" : column.group);
    lines[1].push_back(shown_title(column));
  }
  for (const TableRow& row : table.rows) lines.push_back(row_texts(table, row));
  return lines;
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

std::string block_text(const Table& table, const Lines& lines, const Block& block, bool color) {
  const std::vector<std::size_t> widths = widths_of(lines);
  std::string text;
  for (std::size_t r = 0; r < lines.size(); ++r) {
    text += padded(lines[r][0], widths[0]);
    for (std::size_t i = block.first; i < block.end; ++i) {
      const int rank = r < kNumHeaders ? 0 : table.rows[r - kNumHeaders].cells[i - 1].rank;
      const std::string cell = padded(lines[r][i], widths[i], true);
      text += "  ";
      text += color && rank > 0 ? shaded(cell, rank) : cell;
    }
    text += "\n";
  }
  return text;
}

std::string notes_text(const std::vector<std::string>& notes, std::size_t width) {
  std::string text;
  for (const std::string& note : notes) {
    if (width < 20) {
      text += "  " + note + "\n";
      continue;
    }
    const auto lines = wrapped(note, width - 4);
    for (std::size_t i = 0; i < lines.size(); ++i)
      text += (i == 0 ? "  " : "    ") + lines[i] + "\n";
  }
  return text;
}

// Titles of the rows in which each cell has that status.
std::vector<std::string> rows_with(const Table& table, CellStatus status) {
  std::vector<std::string> titles;
  for (const TableRow& row : table.rows)
    if (std::all_of(row.cells.begin(), row.cells.end(), [&](const TableCell& cell) {
          return cell.status == status;
        }))
      titles.push_back(row.title);
  return titles;
}

// What was measured; methods that were not run are named in a note, and those that failed where no
// column is left to say so.
Table brief_table(const Table& table) {
  const Table measured = without_published(table);
  Table brief = without_empty_columns(measured);
  const std::vector<std::string> absent = rows_with(measured, CellStatus::kMissing),
                                 failed = rows_with(measured, CellStatus::kFailed);
  std::erase_if(brief.rows, [&](const TableRow& row) {
    return std::find(absent.begin(), absent.end(), row.title) != absent.end();
  });
  if (!absent.empty()) brief.notes.push_back(fmt::format("Not run: {}.", fmt::join(absent, ", ")));
  if (!failed.empty() && brief.columns.empty())
    brief.notes.push_back(fmt::format("Failed: {}.", fmt::join(failed, ", ")));
  return brief;
}

// What the values are means of, and marks in cells.
std::vector<std::string> brief_notes(const Table& table) {
  std::vector<std::string> notes = table_notes(table);
  std::erase_if(notes, [](const std::string& note) {
    return !note.starts_with("Mean over") && !note.starts_with("GlassRoom: ") &&
           !note.starts_with("Not in these") && !note.starts_with("Trained for") &&
           !note.starts_with("Not run") && !note.starts_with("Failed: ") &&
           !note.starts_with("* ") && !note.starts_with("≈") && !note.starts_with("‡");
  });
  return notes;
}

}  // namespace

std::string table_terminal(const Table& any_table, TerminalStyle style) {
  Table table = printable_table(any_table);
  if (style.brief) table = without_intervals(brief_table(table));
  const Lines lines = lines_of(table);
  std::string text = table.title + "\n";
  const auto blocks = blocks_of(table, widths_of(lines), style.width);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (i > 0) text += "\n";
    text += block_text(table, lines, blocks[i], style.color);
  }
  return text + notes_text(style.brief ? brief_notes(table) : table_notes(table), style.width);
}

}  // namespace glint
