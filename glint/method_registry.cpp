// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/method.h"

namespace glint {

namespace {

// Number of single-character edits between two names.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

const MethodSpec& find_method(const std::string& id) {
  const auto& methods = Registry<MethodSpec>::all();
  if (const auto found = methods.find(id); found != methods.end()) return found->second;
  std::string known, nearest;
  std::size_t best = id.size() + 1;
  for (const auto& [name, spec] : methods) {
    known += (known.empty() ? "" : ", ") + name;
    const std::size_t distance = edit_distance(id, name);
    if (distance < best) best = distance, nearest = name;
  }
  throw Error(
      ExitCode::kUsage,
      fmt::format(
          "no method '{}'; did you mean '{}'? Known: {}",
          id,
          nearest,
          known.empty() ? "none" : known
      )
  );
}

std::unique_ptr<Method> create_method(const std::string& id, const Json& config) {
  const MethodSpec& spec = find_method(id);
  Json merged = spec.overrides;
  merged.update(config);
  return spec.create(merged);
}

}  // namespace glint
