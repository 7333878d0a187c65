// SPDX-License-Identifier: MIT
// Lengths in another unit than metres show in the ratio to what they are compared with.
#pragma once

#include <cmath>
#include <string>

#include "glint/core/error.h"

namespace glint {

// No reconstruction in metres is wrong by as much at half of its parts.
inline constexpr double kMostLengthRatio = 5;

inline bool is_odd_length_ratio(double ratio) {
  return !(ratio < kMostLengthRatio && ratio > 1 / kMostLengthRatio);
}

// "another unit (millimetres, by the ratio)"; where no unit is near, without it. Ratios of the
// number found to that of metres.
inline std::string likely_unit(double ratio) {
  struct Unit {
    const char* name;
    double per_metre;
  };
  constexpr double kNear = 1.25;
  for (const Unit& unit :
       {Unit{"millimetres", 1000},
        Unit{"centimetres", 100},
        Unit{"inches", 39.37},
        Unit{"decimetres", 10},
        Unit{"decametres", 0.1},
        Unit{"hectometres", 0.01},
        Unit{"kilometres", 0.001}})
    if (std::abs(std::log(ratio / unit.per_metre)) < std::log(kNear))
      return fmt::format("another unit ({}, by the ratio)", unit.name);
  return "another unit";
}

}  // namespace glint
