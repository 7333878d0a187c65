// SPDX-License-Identifier: MIT
#include "datasets/prior_options.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "glint/core/error.h"

namespace glint {
namespace {

void check_word(
    const std::string& word,
    std::span<const std::string_view> known,
    std::string_view where,
    const char* option
) {
  GLINT_CHECK(
      word.empty() || word == "auto" || std::find(known.begin(), known.end(), word) != known.end(),
      kUsage,
      "{}: {} '{}'; expected auto, {}",
      where,
      option,
      word,
      fmt::join(known, ", ")
  );
}

}  // namespace

void check_prior_options(const PriorOptions& options, std::string_view where) {
  check_word(options.axes, kPriorAxes, where, "axes of normal priors");
  check_word(options.depth, kPriorDepths, where, "kind of depth priors");
}

}  // namespace glint
