// SPDX-License-Identifier: MIT
#include <algorithm>
#include <sstream>

#include "glint/core/printable.h"

#include "reports/tables/table_writers.h"

namespace glint {

namespace {

constexpr std::size_t kFoldedTitle = 8;  // characters in a line that titles may always have

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

bool is_arrow(const std::string& word) { return word == "↑" || word == "↓"; }

// Words in lines of at most `width`, where they are no longer; an arrow stays with its word.
std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> words, lines;
  std::istringstream stream(text);
  for (std::string word; stream >> word;)
    if (is_arrow(word) && !words.empty())
      words.back() += " " + word;
    else
      words.push_back(word);
  for (const std::string& word : words)
    if (!lines.empty() && text_width(lines.back()) + 1 + text_width(word) <= width)
      lines.back() += " " + word;
    else
      lines.push_back(word);
  return lines;
}

// Lines of text: the groups, the titles (several lines where they are folded), a line a method.
struct TextRows {
  std::vector<std::vector<std::string>> lines;
  std::size_t num_headers = 2;
  std::string only_group = {};  // of all columns, where its line is left out
};

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

TextRows texts_of(const Table& table) {
  TextRows rows{{{""}, {"Method"}}};
  for (const TableColumn& column : table.columns) {
    rows.lines[0].push_back(column.published ? column.group + "†" : column.group);
    rows.lines[1].push_back(shown_title(column));
  }
  for (const TableRow& row : table.rows) rows.lines.push_back(row_texts(table, row));
  return rows;
}

// The group of all columns; empty: there are several.
std::string only_group(const TextRows& rows) {
  const std::vector<std::string>& groups = rows.lines[0];
  const bool one = groups.size() > 1 && std::all_of(groups.begin() + 1, groups.end(), [&](auto& g) {
                     return g == groups[1];
                   });
  return one ? groups[1] : "";
}

// Titles in as many lines as make them no wider than groups and values, the last one at the bottom.
// One group of all columns needs no line.
TextRows folded(TextRows rows) {
  const std::string group = only_group(rows);
  if (!group.empty()) std::fill(rows.lines[0].begin(), rows.lines[0].end(), "");
  std::vector<std::vector<std::string>> others = rows.lines;
  others[1].assign(1, "");
  const std::vector<std::size_t> widths = widths_of(others);
  std::vector<std::vector<std::string>> titles;
  std::size_t height = 1;
  for (std::size_t i = 0; i < rows.lines[1].size(); ++i) {
    titles.push_back(wrapped(rows.lines[1][i], std::max(widths[i], kFoldedTitle)));
    height = std::max(height, titles.back().size());
  }
  TextRows result{{}, height, group};
  if (group.empty()) {
    result.lines.push_back(rows.lines[0]);
    ++result.num_headers;
  }
  for (std::size_t h = 0; h < height; ++h) {
    result.lines.emplace_back();
    for (const auto& title : titles) {
      const std::size_t above = height - title.size();
      result.lines.back().push_back(h < above ? "" : title[h - above]);
    }
  }
  result.lines.insert(result.lines.end(), rows.lines.begin() + 2, rows.lines.end());
  return result;
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

std::string block_text(const Table& table, const TextRows& rows, const Block& block, bool color) {
  const std::vector<std::size_t> widths = widths_of(rows.lines);
  std::string text;
  for (std::size_t r = 0; r < rows.lines.size(); ++r) {
    text += padded(rows.lines[r][0], widths[0], true);
    for (std::size_t i = block.first; i < block.end; ++i) {
      const bool header = r < rows.num_headers;
      const int rank = header ? 0 : table.rows[r - rows.num_headers].cells[i - 1].rank;
      const std::string cell = padded(rows.lines[r][i], widths[i], false);
      text += "  ";
      text += color && rank > 0 ? shaded(cell, rank) : cell;
    }
    text += "\n";
  }
  return text;
}

bool fits(const TextRows& rows, std::size_t width) {
  const auto widths = widths_of(rows.lines);
  return width == 0 || width_of({1, widths.size()}, widths) <= width;
}

// The table with the columns that have room, its lines, and what to say of the others.
struct Layout {
  Table table;
  TextRows rows;
  std::vector<std::string> notes;
};

Layout layout_of(const Table& table, TerminalStyle style) {
  Layout layout{table, texts_of(table), {}};
  if (fits(layout.rows, style.width)) return layout;
  const auto refill = [&](Table fewer) {
    layout.table = std::move(fewer);
    layout.rows = folded(texts_of(layout.table));
    return fits(layout.rows, style.width);
  };
  const Table plain = without_intervals(table);
  if (plain.notes.size() < table.notes.size())
    layout.notes.emplace_back("Intervals are left out: the terminal is too narrow.");
  layout.table = plain;
  layout.rows = texts_of(plain);
  if (fits(layout.rows, style.width) || refill(plain)) return layout;
  const Table filled = without_empty_columns(plain);
  if (filled.columns.size() < table.columns.size())
    layout.notes.emplace_back("Columns without a value are left out.");
  if (refill(filled)) return layout;
  const Table measured = without_published(filled);
  if (measured.columns.size() < filled.columns.size())
    layout.notes.emplace_back("Published columns are left out: the terminal is too narrow.");
  refill(measured);
  return layout;
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

std::size_t text_width(std::string_view utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u;  // not a continuation byte
  }));
}

std::string aligned_rows(
    const std::vector<std::vector<std::string>>& rows, const std::set<std::size_t>& words
) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i)
      line += (i ? "  " : "") + padded(row[i], widths[i], words.count(i) > 0);
    line.erase(line.find_last_not_of(' ') + 1);
    text += printable(line) + "\n";
  }
  return text;
}

std::string table_terminal(const Table& any_table, TerminalStyle style) {
  const Table table = printable_table(any_table);
  const Layout layout =
      layout_of(style.brief ? without_intervals(brief_table(table)) : table, style);
  const std::string& group = layout.rows.only_group;
  std::string text = table.title + (group.empty() ? "" : ", " + group) + "\n";
  const auto blocks = blocks_of(layout.table, widths_of(layout.rows.lines), style.width);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (i > 0) text += "\n";
    text += block_text(layout.table, layout.rows, blocks[i], style.color);
  }
  auto notes = style.brief ? brief_notes(layout.table) : table_notes(layout.table);
  notes.insert(notes.end(), layout.notes.begin(), layout.notes.end());
  return text + notes_text(notes, style.width);
}

}  // namespace glint
