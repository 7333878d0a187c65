// SPDX-License-Identifier: MIT
// The known word that a misspelt one may have meant, for messages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace glint {

// Edits that make one word of the other: insert, remove or replace a character, swap two
// neighbours.
std::size_t edit_distance(std::string_view a, std::string_view b);

// The first known word that begins with the word (of three letters or more), or else the one with
// the fewest edits, about a third of the word's letters at most. Case does not count. Empty: none
// is near.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

// "did you mean 'x'? ", or nothing where no word is near: stands in front of the list of known
// ones.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

// "a, b, c"
std::string comma_list(const std::vector<std::string>& words);

}  // namespace glint
