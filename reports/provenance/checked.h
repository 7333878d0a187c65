// SPDX-License-Identifier: MIT
// One thing that was looked at, and how it was found: rows of `verify`, `audit` and `doctor`.
#pragma once

#include <string>
#include <string_view>

namespace glint {

enum class Verdict {
  kOk,
  kNote,  // worth knowing, and no failure
  kBad,
};

inline std::string_view verdict_word(Verdict verdict) {
  if (verdict == Verdict::kOk) return "ok";
  return verdict == Verdict::kNote ? "note" : "BAD";
}

struct Checked {
  std::string name;
  Verdict verdict = Verdict::kOk;
  std::string detail;
};

}  // namespace glint
