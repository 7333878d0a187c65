// SPDX-License-Identifier: MIT
#include "glint/core/json_error.h"

#include <string_view>

namespace glint {

namespace {

// Removes what stands between the two, and both.
void remove_between(std::string& text, std::string_view from, std::string_view to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return;
  const std::size_t end = text.find(to, begin + from.size());
  if (end != std::string::npos) text.erase(begin, end + to.size() - begin);
}

// Was the last thing read the beginning of NaN or Infinity?
bool is_no_number(std::string_view text) {
  const std::size_t end = text.find_last_of('\'');
  if (end == std::string_view::npos || end == 0) return false;
  const char last = text[end - 1];
  return last == 'N' || last == 'I';
}

}  // namespace

std::string json_error(const nlohmann::json::exception& error) {
  std::string text = error.what();
  remove_between(text, "[json.exception.", "] ");
  remove_between(text, "parse error ", "at ");
  remove_between(text, "syntax error while parsing", " - ");
  if (text.find("invalid literal") != std::string::npos && is_no_number(text))
    text += "; NaN and Infinity, which Python writes, are no JSON: leave the entry out";
  return text;
}

}  // namespace glint
