// SPDX-License-Identifier: MIT
// Names of the strengths of GlassRoom's simulated priors, and of their single flaws. priors.h says
// what they stand for.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/nearest.h"

namespace glint {

inline constexpr const char* kDefaultPriorLevel = "default";
// From the strongest priors to the weakest.
inline constexpr std::array kPriorLevels{"perfect", "good", kDefaultPriorLevel, "poor", "bad"};

// The default with one of the errors of "poor".
inline constexpr std::array kPriorFlaws{"noise", "see-through", "gaps", "dark-leak", "bright-leak"};

inline std::vector<std::string> prior_levels() {
  return {kPriorLevels.begin(), kPriorLevels.end()};
}
// All that `priors` may be: the levels, then the flaws.
inline std::vector<std::string> prior_kinds() {
  std::vector<std::string> kinds = prior_levels();
  kinds.insert(kinds.end(), kPriorFlaws.begin(), kPriorFlaws.end());
  return kinds;
}

// Errors (kUsage): no such level or flaw; `where` and the field open the message, which lists them.
inline void check_prior_level(const std::string& name, const std::string& where) {
  const std::vector<std::string> known = prior_kinds();
  GLINT_CHECK(
      std::find(known.begin(), known.end(), name) != known.end(),
      kUsage,
      "{}: priors is '{}'; {}expected one of {}",
      where,
      name,
      did_you_mean(name, known),
      comma_list(known)
  );
}

}  // namespace glint
