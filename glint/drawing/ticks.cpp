// SPDX-License-Identifier: MIT
#include "glint/drawing/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace glint {

namespace {

constexpr double kMostSteps = 6;
constexpr int kMostDecimals = 9;

// The fewest that print the number as it is.
int decimals_of(double number) {
  double power = 1;
  for (int decimals = 0; decimals < kMostDecimals; ++decimals, power *= 10) {
    const double scaled = std::abs(number) * power;
    if (std::abs(scaled - std::round(scaled)) < 1e-6 * std::max(1.0, scaled)) return decimals;
  }
  return kMostDecimals;
}

struct Unit {
  double size;
  const char* suffix;
};
Unit unit_of(double largest) {
  if (largest >= 1e7) return {1e6, "M"};
  if (largest >= 1e4) return {1e3, "k"};
  return {1, ""};
}

}  // namespace

std::vector<double> round_ticks(double low, double high) {
  const double rough = (high - low) / kMostSteps;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= rough) step = factor * power;
  std::vector<double> ticks;
  for (double tick = std::ceil(low / step); tick * step <= high; ++tick)
    ticks.push_back(tick == 0 ? 0 : tick * step);
  return ticks;
}

std::vector<double> log_ticks(double low, double high) {
  std::vector<double> all, powers;
  for (double power = std::pow(10.0, std::floor(std::log10(low))); power <= high; power *= 10)
    for (const double factor : {1.0, 2.0, 5.0})
      if (const double tick = factor * power; tick >= low && tick <= high) {
        all.push_back(tick);
        if (factor == 1.0) powers.push_back(tick);
      }
  if (all.size() < 2) return round_ticks(low, high);
  return powers.size() >= 3 ? powers : all;
}

std::vector<std::string> tick_labels(const std::vector<double>& ticks) {
  double largest = 0;
  for (const double tick : ticks) largest = std::max(largest, std::abs(tick));
  const Unit unit = unit_of(largest);
  int decimals = 0;
  for (const double tick : ticks) decimals = std::max(decimals, decimals_of(tick / unit.size));
  std::vector<std::string> labels;
  for (const double tick : ticks) {
    const std::string number = fmt::format("{:.{}f}", std::abs(tick) / unit.size, decimals);
    labels.push_back((tick < 0 ? "−" : "") + number + (tick == 0 ? "" : unit.suffix));
  }
  return labels;
}

}  // namespace glint
