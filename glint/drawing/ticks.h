// SPDX-License-Identifier: MIT
// Where an axis is marked, and with which words.
#pragma once

#include <string>
#include <vector>

namespace glint {

// Two to seven round numbers (1, 2 or 5 times a power of ten apart) within [low, high]; low < high.
std::vector<double> round_ticks(double low, double high);

// The same for an axis of logarithms: 1, 2 and 5 times powers of ten; the powers alone where there
// are three of them or more, round_ticks() where a narrow range has fewer than two. 0 < low < high.
std::vector<double> log_ticks(double low, double high);

// All with the decimals that the finest needs: "0.0", "0.5"; from ten thousand on in thousands,
// "20k", from ten millions on in millions, "20M".
std::vector<std::string> tick_labels(const std::vector<double>& ticks);

}  // namespace glint
