// SPDX-License-Identifier: MIT
#include "reports/show/pictures/growth_log.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "glint/core/config.h"
#include "glint/core/presence.h"

namespace glint {

namespace {

constexpr std::size_t kCounts = 100, kParts = 40;

void add(Course& course, double step, const Json& json, const std::string& name) {
  const auto it = json.find(name);
  if (it == json.end() || !it->is_number()) return;
  course.x.push_back(step);
  course.y.push_back(it->get<double>());
}

void add_line(GrowthLog& log, const Json& line) {
  const double step = line["iteration"].get<double>() + 1;
  log.steps = static_cast<int>(step);
  add(log.surfels, step, line, "num_surfels");
  add(log.psnr, step, line, "psnr");
  add(log.test_psnr, step, line, "test_psnr");
  const auto sets = line.find("sets");
  if (sets == line.end() || !sets->is_object()) return;
  for (const auto& [name, count] : sets->items()) add(log.sets[name], step, *sets, name);
}

// f(begin, end) of each of at most so many runs of neighbouring lines.
template <class F>
void for_each_part(std::size_t lines, std::size_t most, F&& f) {
  const std::size_t parts = std::min(lines, most);
  for (std::size_t i = 0; i < parts; ++i) f(i * lines / parts, (i + 1) * lines / parts);
}

// The last of each part.
Course thinned(const Course& course) {
  Course result;
  for_each_part(course.x.size(), kCounts, [&](std::size_t, std::size_t end) {
    result.x.push_back(course.x[end - 1]);
    result.y.push_back(course.y[end - 1]);
  });
  return result;
}

double mean_of(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += values[i];
  return sum / static_cast<double>(end - begin);
}

Course averaged(const Course& course) {
  Course result;
  for_each_part(course.x.size(), kParts, [&](std::size_t begin, std::size_t end) {
    result.x.push_back(mean_of(course.x, begin, end));
    result.y.push_back(mean_of(course.y, begin, end));
  });
  return result;
}

}  // namespace

GrowthLog read_growth_log(const fs::path& file) {
  GrowthLog log;
  if (!is_file(file)) return log;
  std::istringstream lines(read_file(file));
  for (std::string text; std::getline(lines, text);) {
    const Json line = parse_json(text);
    if (line.is_object() && line.contains("iteration") && line["iteration"].is_number())
      add_line(log, line);
  }
  log.surfels = thinned(log.surfels);
  log.psnr = averaged(log.psnr);
  for (auto& [name, course] : log.sets) course = thinned(course);
  return log;
}

}  // namespace glint
