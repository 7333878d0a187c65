// SPDX-License-Identifier: MIT
// What `eval` prints of a run's scores.
#pragma once

#include <map>
#include <string>

namespace glint {

// The ten columns of the summary table that say how good a run is, a line each with unit and which
// way is better; "-": the run or its data have no such value.
std::string headline_scores(const std::map<std::string, double>& means);

// Every value by its id, with its unit.
std::string all_scores(const std::map<std::string, double>& means);

}  // namespace glint
