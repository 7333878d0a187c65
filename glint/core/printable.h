// SPDX-License-Identifier: MIT
// Text from files and file names as a terminal may show it, and as a spreadsheet may open it.
#pragma once

#include <cstdlib>
#include <string>
#include <string_view>

namespace glint {

// Control characters but for line breaks and tabs as \x1b: a terminal would obey them. So are the
// C1 ones, which in UTF-8 are the bytes c2 80 to c2 9f.
inline std::string printable(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool is_c1 = byte == 0xc2 && i + 1 < text.size() &&
                       static_cast<unsigned char>(text[i + 1]) >= 0x80 &&
                       static_cast<unsigned char>(text[i + 1]) < 0xa0;
    const auto code = is_c1 ? static_cast<unsigned char>(text[++i]) : byte;
    const bool obeyed = is_c1 || (byte < 32 && byte != '\n' && byte != '\t') || byte == 127;
    if (obeyed)
      shown += {'\\', 'x', kDigits[code / 16], kDigits[code % 16]};
    else
      shown += text[i];
  }
  return shown;
}

// A field of CSV: quoted where it has a separator, quote or line break. What a spreadsheet would
// take for a formula gets an apostrophe in front; numbers stay.
inline std::string csv_field(std::string text) {
  const auto is_number = [&] {
    char* end = nullptr;
    std::strtod(text.c_str(), &end);
    return end == text.c_str() + text.size();
  };
  const bool is_formula =
      text.size() > 1 && std::string_view("=+-@\t\r").find(text.front()) != std::string_view::npos;
  if (is_formula && !is_number()) text.insert(0, 1, '\'');
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

// A word of a command that people copy into a shell: what a shell would read is quoted.
inline std::string shell_word(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos)
    return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace glint
