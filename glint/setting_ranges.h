// SPDX-License-Identifier: MIT
// What numbers among the settings may be. A name means the same whichever methods have the setting,
// so its range is stated once, and is looked at before any data are.
#pragma once

#include <limits>
#include <span>
#include <string>

#include "glint/core/config.h"

namespace glint {

struct ValueRange {
  double least, most = std::numeric_limits<double>::infinity();
  bool without_least = false, without_most = false;

  bool holds(double value) const;
  std::string text() const;  // "at least 1", "above 0 and below 1"
};

struct SettingRange {
  const char* name;
  ValueRange range;
  // A setting that, where it is 0 or not there, makes this one mean nothing; null: none.
  const char* unless_zero = nullptr;
};
std::span<const SettingRange> setting_ranges();

// Errors (kUsage): a setting of `config` outside of its range; names it, its value and the range.
// `method` opens the message.
void check_settings(const std::string& method, const Json& config);

}  // namespace glint
