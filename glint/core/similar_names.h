// SPDX-License-Identifier: MIT
// Names that one system takes for the same and another does not: of other case (Windows), letters
// with marks as one character or two (macOS).
#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace glint {

// Letters without their marks, of U+00C0 to U+017F (Unicode's canonical decompositions); '?': has
// none.
inline constexpr std::string_view kUnmarked =
    "aaaaaa?ceeeeiiii?nooooo??uuuuy??aaaaaa?ceeeeiiii?nooooo??uuuuy?y"
    "aaaaaaccccccccdd??eeeeeeeeeegggggggghh??iiiiiiiii???jjkk?llllll?"
    "???nnnnnn???oooooo??rrrrrrsssssssstttt??uuuuuuuuuuuuwwyyyzzzzzz?";

// The same for names that are alike: ASCII in lower case, without marks (U+0300 to U+036F).
inline std::string name_key(std::string_view name) {
  std::string key;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto byte = static_cast<unsigned char>(name[i]);
    const auto next = i + 1 < name.size() ? static_cast<unsigned char>(name[i + 1]) : 0u;
    const unsigned code = (byte & 0xe0) == 0xc0 ? (byte & 0x1fu) << 6 | (next & 0x3fu) : byte;
    if (code >= 0x300 && code <= 0x36f) {
      ++i;  // a mark
    } else if (code >= 0xc0 && code < 0x180 && kUnmarked[code - 0xc0] != '?') {
      key += kUnmarked[code - 0xc0];
      ++i;
    } else {
      key += static_cast<char>(std::tolower(byte));
    }
  }
  return key;
}

}  // namespace glint
