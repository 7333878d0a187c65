// SPDX-License-Identifier: MIT
#include "reports/show/tables/common_scenes.h"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace glint {

namespace {

bool has_all(const SizedScenes& scenes, const SizedScenes& wanted) {
  return std::includes(scenes.begin(), scenes.end(), wanted.begin(), wanted.end());
}

std::set<SizedScenes> candidate_sets(const std::map<std::string, SizedScenes>& by_method) {
  std::set<SizedScenes> own, candidates;
  for (const auto& [method, scenes] : by_method) own.insert(scenes);
  for (const SizedScenes& a : own)
    for (const SizedScenes& b : own) {
      SizedScenes shared;
      std::set_intersection(
          a.begin(), a.end(), b.begin(), b.end(), std::inserter(shared, shared.end())
      );
      candidates.insert(std::move(shared));
    }
  return candidates;
}

}  // namespace

std::string SizedScene::text() const {
  return resolution.empty() ? scene : scene + " at " + resolution;
}

SizedScene sized_scene(const Record& record) { return {record.cell.scene, record.resolution}; }

SizedScenes common_scenes(const std::map<std::string, SizedScenes>& by_method) {
  SizedScenes best;
  std::size_t most = 0;
  for (const SizedScenes& candidate : candidate_sets(by_method)) {
    const auto methods = static_cast<std::size_t>(std::count_if(
        by_method.begin(),
        by_method.end(),
        [&](const auto& method) { return has_all(method.second, candidate); }
    ));
    const std::size_t values = methods * candidate.size();
    if (std::tuple(values, candidate.size()) > std::tuple(most, best.size())) {
      most = values;
      best = candidate;
    }
  }
  return best;
}

std::map<std::string, SizedScenes> common_scenes(const std::vector<Record>& records) {
  std::map<std::string, std::map<std::string, SizedScenes>> by_dataset;
  for (const Record& record : records)
    if (record.ok()) by_dataset[record.dataset][record.cell.method].insert(sized_scene(record));
  std::map<std::string, SizedScenes> common;
  for (const auto& [dataset, by_method] : by_dataset) common[dataset] = common_scenes(by_method);
  return common;
}

std::string scenes_text(const SizedScenes& scenes, bool with_sizes) {
  std::set<std::string> names;
  for (const SizedScene& scene : scenes) names.insert(with_sizes ? scene.text() : scene.scene);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace glint
