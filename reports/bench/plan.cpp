// SPDX-License-Identifier: MIT
#include "reports/bench/plan.h"

#include <algorithm>

#include "glint/method.h"
#include "metrics/metric.h"
#include "reports/records/revision.h"

namespace glint {

namespace {

bool matches(const std::string& pattern, const CellKey& cell) {
  const std::string scene_method = cell.scene + "/" + cell.method;
  for (const std::string& text : {cell.text(), scene_method, cell.scene, cell.method})
    if (glob_match(pattern, text)) return true;
  return false;
}

bool any_matches(const std::vector<std::string>& patterns, const CellKey& cell) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
    return matches(pattern, cell);
  });
}

// The resolved configuration: defaults that change with the code change the hash too.
std::string config_hash_of(const PlanCell& cell, int iterations) {
  const Json resolved = create_method(cell.cell.method, cell.config)->config();
  const Json identity = {
      {"method", cell.cell.method},
      {"config", resolved},
      {"iterations", iterations},
      {"seed", cell.cell.seed},
      {"sources", source_hash()}};
  return hash_text(identity.dump());
}

// What the machine lacked for some metric then, it has now.
bool can_measure_more(const Record& record) {
  if (record.not_measured.empty()) return false;
  const std::map<std::string, std::string> missing = missing_metrics();
  return std::any_of(
      record.not_measured.begin(),
      record.not_measured.end(),
      [&](const auto& entry) {
        const bool of_mesh = entry.first.find("mesh-") != std::string::npos;  // not the machine's
        return !of_mesh && !missing.contains(entry.first);
      }
  );
}

}  // namespace

bool filter_accepts(const CellFilter& filter, const CellKey& cell) {
  return (filter.only.empty() || any_matches(filter.only, cell)) && !any_matches(filter.skip, cell);
}

std::vector<PlanCell> make_plan(
    const Profile& profile, const CellFilter& filter, const std::vector<std::string>& assignments
) {
  std::vector<PlanCell> plan;
  for (const SceneSource& source : profile.sources())
    for (const std::string& method : profile.methods)
      for (const std::uint64_t seed : profile.seeds) {
        PlanCell cell{{source.scene, method, seed}, source, {}, {}};
        if (!filter_accepts(filter, cell.cell)) continue;
        cell.config = method_overrides(profile, method, assignments);
        cell.config_hash = config_hash_of(cell, profile.iterations);
        plan.push_back(std::move(cell));
      }
  GLINT_CHECK(
      !plan.empty(),
      kUsage,
      "no cell left: profile {} has {} scenes and {} methods, none passes --only and --skip",
      profile.name,
      profile.scenes.size(),
      profile.methods.size()
  );
  return plan;
}

CellState state_of(
    const PlanCell& cell, const std::vector<Record>& records, const std::string& dataset_hash
) {
  const Record* record = find_record(records, cell.cell);
  if (!record) return CellState::kPending;
  const bool same_data = dataset_hash.empty() || record->dataset_hash == dataset_hash;
  if (record->config_hash != cell.config_hash || !same_data) return CellState::kStale;
  if (!record->ok()) return CellState::kFailed;
  return can_measure_more(*record) ? CellState::kStale : CellState::kDone;
}

std::string_view state_name(CellState state) {
  switch (state) {
    case CellState::kDone:
      return "done";
    case CellState::kFailed:
      return "failed";
    case CellState::kStale:
      return "stale";
    case CellState::kPending:
      return "pending";
  }
  return "pending";
}

double estimated_seconds(const PlanCell& cell, const std::vector<Record>& records) {
  double sum = 0;
  int count = 0;
  for (const Record& record : records)
    if (record.ok() && record.cell.method == cell.cell.method) {
      for (const auto& [stage, seconds] : record.timings.items())
        if (stage != "dataset") sum += seconds.get<double>();
      ++count;
    }
  return count > 0 ? sum / count : 0;
}

}  // namespace glint
