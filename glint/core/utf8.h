// SPDX-License-Identifier: MIT
// Names in files of others may be of any bytes; JSON and pages hold UTF-8 alone.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace glint {

// Bytes of the character of UTF-8 that begins there; 0: none does (RFC 3629: no longer form than
// needed, no surrogates, nothing beyond 10ffff).
inline std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) -> unsigned {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0;
  };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return 1;
  if (first < 0xc2 || first > 0xf4) return 0;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const bool is_out = (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
                      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f);
  return is_out ? 0 : length;
}

inline bool is_utf8(std::string_view text) {
  for (std::size_t at = 0, length = 0; at < text.size(); at += length)
    if ((length = utf8_length(text, at)) == 0) return false;
  return true;
}

// Bytes that are no UTF-8 as \xe9.
inline std::string as_utf8(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string shown;
  for (std::size_t at = 0, length = 0; at < text.size(); at += std::max<std::size_t>(length, 1)) {
    length = utf8_length(text, at);
    const auto code = static_cast<unsigned char>(text[at]);
    if (length == 0)
      shown += {'\\', 'x', kDigits[code / 16], kDigits[code % 16]};
    else
      shown += text.substr(at, length);
  }
  return shown;
}

}  // namespace glint
