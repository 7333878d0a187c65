// SPDX-License-Identifier: MIT
// One thing that was looked at, and how it was found: rows of `verify` and `doctor`.
#pragma once

#include <string>
#include <string_view>

namespace glint {

enum class CheckState {
  kOk,
  kNote,  // worth knowing, and no failure
  kBad,
};

inline std::string_view state_word(CheckState state) {
  if (state == CheckState::kOk) return "ok";
  return state == CheckState::kNote ? "note" : "BAD";
}

struct Checked {
  std::string name;
  CheckState state = CheckState::kOk;
  std::string detail;
  std::string advice = {};  // what to do; empty: nothing
};

}  // namespace glint
