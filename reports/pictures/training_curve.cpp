// SPDX-License-Identifier: MIT
#include "reports/pictures/training_curve.h"

#include <cmath>
#include <sstream>
#include <vector>

#include "reports/records/script_text.h"

namespace glint {

namespace {

struct Step {
  double iteration = 0, seconds = 0, loss = 0, psnr = 0, num_surfels = 0;
};

double number(const Json& json, const char* name) {
  const auto it = json.find(name);
  return it != json.end() && it->is_number() ? it->get<double>() : std::nan("");
}

std::vector<Step> read_steps(const fs::path& log) {
  std::vector<Step> steps;
  std::istringstream lines(read_file(log));
  for (std::string line; std::getline(lines, line);) {
    const Json json = Json::parse(line, nullptr, false);
    if (json.is_object() && json.contains("iteration"))
      steps.push_back(
          {number(json, "iteration"),
           number(json, "seconds"),
           number(json, "loss"),
           number(json, "psnr"),
           number(json, "num_surfels")}
      );
  }
  return steps;
}

double mean_of(
    const std::vector<Step>& steps, std::size_t begin, std::size_t end, double Step::*field
) {
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += steps[i].*field;
  return sum / static_cast<double>(end - begin);
}

}  // namespace

Json training_curve(const fs::path& log, std::size_t points) {
  if (!fs::is_regular_file(log)) return nullptr;
  const std::vector<Step> steps = read_steps(log);
  if (steps.empty()) return nullptr;
  Json curve = Json::object();
  const std::size_t count = std::min(points, steps.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i * steps.size() / count, end = (i + 1) * steps.size() / count;
    const Step& last = steps[end - 1];
    curve["iteration"].push_back(short_number(last.iteration));
    curve["seconds"].push_back(short_number(last.seconds));
    curve["loss"].push_back(short_number(mean_of(steps, begin, end, &Step::loss)));
    curve["psnr"].push_back(short_number(mean_of(steps, begin, end, &Step::psnr)));
    curve["num_surfels"].push_back(short_number(last.num_surfels));
  }
  return curve;
}

}  // namespace glint
