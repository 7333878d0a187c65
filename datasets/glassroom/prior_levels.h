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

// The default with one of the errors of "poor"; joined by '+', with several: noise+see-through.
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

inline bool is_prior_flaw(const std::string& name) {
  return std::find(kPriorFlaws.begin(), kPriorFlaws.end(), name) != kPriorFlaws.end();
}
// The parts between the '+' of a name.
inline std::vector<std::string> joined_flaws(const std::string& name) {
  std::vector<std::string> parts(1);
  for (const char c : name)
    if (c == '+')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

// Errors (kUsage): no such level or flaw, or what is joined are not all flaws; `where` and the
// field open the message, which lists them.
inline void check_prior_level(const std::string& name, const std::string& where) {
  const std::vector<std::string> known = prior_kinds(), parts = joined_flaws(name);
  const bool is_known = std::find(known.begin(), known.end(), name) != known.end();
  GLINT_CHECK(
      is_known || std::all_of(parts.begin(), parts.end(), is_prior_flaw),
      kUsage,
      "{}: priors is '{}'; {}expected one of {}, or some of the last {} joined by +",
      where,
      name,
      did_you_mean(name, known),
      comma_list(known),
      kPriorFlaws.size()
  );
}

}  // namespace glint
