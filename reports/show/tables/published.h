// SPDX-License-Identifier: MIT
// The paper's numbers as printed (reports/paper/glint.json). They were measured by its authors on
// their own data; no table mixes them with measured ones without a mark.
#pragma once

#include <string>
#include <vector>

namespace glint {

struct PublishedValue {
  std::string table, dataset, row, column;
  std::string text;  // decimal string as printed, "0.90"; or the printed phrase, "~2.5 h"
  double value = 0;  // in `unit`, hours turned into minutes
  int decimals = 0;
  std::string unit, direction, source;
};

const std::vector<PublishedValue>& published_values();

// nullptr: the paper has no such cell.
const PublishedValue* find_published(
    const std::string& table,
    const std::string& dataset,
    const std::string& row,
    const std::string& column
);

}  // namespace glint
