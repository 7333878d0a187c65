// SPDX-License-Identifier: MIT
#include "glint/core/rows.h"

#include <algorithm>
#include <sstream>

#include "glint/core/error.h"

namespace glint {

namespace {

constexpr std::size_t kNarrowest = 24;  // characters of a last column that is worth wrapping

bool at(const std::vector<bool>& flags, std::size_t i) { return i < flags.size() && flags[i]; }

// The last cell, in lines below each other behind what stands before it.
std::string last_cell(const std::string& text, std::size_t indent, std::size_t width) {
  if (width < indent + kNarrowest) return text;
  std::string shown;
  for (const std::string& line : wrapped(text, width - indent)) {
    if (!shown.empty()) shown.append("\n").append(indent, ' ');
    shown += line;
  }
  return shown;
}

}  // namespace

std::string Cell::text(const Column& column) const {
  if (words_) return *words_;
  if (value_.is_null()) return "-";
  if (value_.is_string()) return value_.get<std::string>();
  if (value_.is_boolean()) return value_.get<bool>() ? "yes" : "no";
  return fmt::format(
      fmt::runtime(column.format.empty() ? "{}" : column.format), value_.get<double>()
  );
}

Rows::Rows(std::vector<Column> columns, std::string_view data)
    : num_shown_(columns.size()), columns_(std::move(columns)) {
  std::istringstream keys{std::string(data)};
  for (std::string key; keys >> key;) columns_.push_back({key});
}

void Rows::add(std::vector<Cell> cells) {
  GLINT_CHECK(
      cells.size() == columns_.size(),
      kUsage,
      "a row of {} cells in a listing of {} columns",
      cells.size(),
      columns_.size()
  );
  rows_.push_back(std::move(cells));
}

Json Rows::json() const {
  Json list = Json::array();
  for (const auto& row : rows_) {
    Json& object = list.emplace_back(Json::object());
    for (std::size_t i = 0; i < row.size(); ++i)
      if (!columns_[i].key.empty() && !row[i].value().is_discarded())
        object[columns_[i].key] = row[i].value();
  }
  return list;
}

std::vector<std::vector<std::string>> Rows::lines() const {
  std::vector<std::vector<std::string>> lines(1);
  for (std::size_t i = 0; i < num_shown_; ++i) lines[0].push_back(columns_[i].heading);
  const auto is_empty = [](const std::string& heading) { return heading.empty(); };
  if (std::all_of(lines[0].begin(), lines[0].end(), is_empty)) lines.clear();
  for (const auto& row : rows_) {
    lines.emplace_back();
    for (std::size_t i = 0; i < num_shown_; ++i) lines.back().push_back(row[i].text(columns_[i]));
  }
  return lines;
}

std::string Rows::text(std::size_t width) const {
  std::vector<bool> right;
  for (const Column& column : columns_) right.push_back(!column.format.empty());
  return aligned_rows(lines(), width, right);
}

std::string aligned_rows(
    const std::vector<std::vector<std::string>>& rows,
    std::size_t width,
    const std::vector<bool>& right
) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      line += padded(row[i], widths[i], at(right, i)) + "  ";
    const std::size_t last = row.size() - 1;
    if (!row.empty())
      line += at(right, last) ? padded(row[last], widths[last], true)
                              : last_cell(row[last], text_width(line), width);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;)
    if (!lines.empty() && text_width(lines.back()) + 1 + text_width(word) <= width)
      lines.back() += " " + word;
    else
      lines.push_back(word);
  return lines;
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, text_width(text)), ' ');
  return right ? space + text : text + space;
}

std::size_t text_width(std::string_view utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u;  // not a continuation byte
  }));
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

}  // namespace glint
