// SPDX-License-Identifier: MIT
// Features at a network's taps of the images that others are compared with. Targets of a training
// come again: those with a number are kept while there is room, so that the network runs once over
// each.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "glint/core/arrays.h"

namespace glint {

using LpipsTaps = std::vector<FloatArray>;  // each [H][W][channels]

class LpipsTargets {
 public:
  // Of memory, for all that is kept.
  explicit LpipsTargets(std::size_t most_bytes) : bytes_left_(most_bytes) {}

  // Null: not kept, or without a number.
  const LpipsTaps* find(std::optional<std::size_t> target) const {
    const auto found = target ? kept_.find(*target) : kept_.end();
    return found == kept_.end() ? nullptr : &found->second;
  }
  // Where a target's features of so many bytes go; without a number, or where there is no room, a
  // place that the next one overwrites.
  LpipsTaps& place_for(std::optional<std::size_t> target, std::size_t bytes) {
    if (!target || bytes > bytes_left_) return passing_;
    bytes_left_ -= bytes;
    return kept_[*target];
  }
  std::size_t num_kept() const { return kept_.size(); }

 private:
  std::size_t bytes_left_;
  LpipsTaps passing_;
  std::map<std::size_t, LpipsTaps> kept_;
};

}  // namespace glint
