// SPDX-License-Identifier: MIT
#include "reports/verbs/listing.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace glint {

namespace {

constexpr std::size_t kNarrowest = 24;  // characters of a last column that is worth wrapping

// Words in lines of at most `width` characters, with `indent` blanks before all but the first.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::istringstream words(text);
  std::string result, word;
  std::size_t length = 0;
  while (words >> word) {
    const bool fits = length == 0 || length + 1 + word.size() <= width;
    if (!fits) result += "\n" + std::string(indent, ' ');
    if (fits && length > 0) result += " ";
    length = fits && length > 0 ? length + 1 + word.size() : word.size();
    result += word;
  }
  return result;
}

// Of all columns but the last of each row.
std::vector<std::size_t> widths_of_columns(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      if (widths.size() <= i) widths.push_back(0);
      widths[i] = std::max(widths[i], row[i].size());
    }
  return widths;
}

}  // namespace

std::string listing(const std::vector<std::vector<std::string>>& rows, std::size_t width) {
  const std::vector<std::size_t> widths = widths_of_columns(rows);
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      line += row[i] + std::string(widths[i] - row[i].size() + 2, ' ');
    const std::size_t indent = line.size();
    if (!row.empty())
      line +=
          width < indent + kNarrowest ? row.back() : wrapped(row.back(), indent, width - indent);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::size_t terminal_width() {
  if (const char* columns = std::getenv("COLUMNS"))
    if (const long width = std::strtol(columns, nullptr, 10); width > 0)
      return static_cast<std::size_t>(width);
  winsize size{};
  return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace glint
