// SPDX-License-Identifier: MIT
#include "reports/bench/plan.h"

#include "glint/core/nearest.h"
#include "glint/method.h"

namespace glint {

namespace {

// For a misspelt scene or method of --only.
std::string hint_for(const Profile& profile, const CellFilter& filter) {
  std::vector<std::string> known = profile.methods;
  for (const SceneSource& source : profile.sources()) known.push_back(source.scene);
  for (const std::string& pattern : filter.only)
    if (const std::string nearest = nearest_word(pattern, known); !nearest.empty())
      return fmt::format("; did you mean '{}'?", nearest);
  return "; scenes and methods: " + comma_list(known) +
         "; a method that the profile does not name is run by --methods";
}

}  // namespace

std::vector<PlanCell> make_plan(
    const Profile& profile, const CellFilter& filter, const std::vector<std::string>& assignments
) {
  const auto methods = planned_methods(profile.methods, filter.methods);
  for (const auto& entry : profile.overrides.items())
    create_method(entry.key(), entry.value());  // also of those that are not run
  const CellFilter of_profile{.skip = profile.leave_out};
  std::vector<PlanCell> plan;
  for (const SceneSource& source : profile.sources())
    for (const std::string& method : methods)
      for (const std::uint64_t seed : profile.seeds) {
        PlanCell cell{{source.scene, method, seed}, source, {}};
        if (!filter_accepts(filter, cell.cell) || !filter_accepts(of_profile, cell.cell)) continue;
        cell.config = method_overrides(profile, method, assignments);
        create_method(method, cell.config);  // unknown methods and fields stop here
        plan.push_back(std::move(cell));
      }
  GLINT_CHECK(
      !plan.empty(),
      kUsage,
      "no cell left: profile {} has {} scenes and {} methods, none passes --only and --skip{}",
      profile.name,
      profile.scenes.size(),
      methods.size(),
      hint_for(profile, filter)
  );
  return plan;
}

std::optional<double> estimated_seconds(
    const PlanCell& cell, const std::vector<Record>& records, const std::vector<std::string>& stages
) {
  double sum = 0;
  int count = 0;
  for (const Record& record : records)
    if (record.ok() && record.cell.method == cell.cell.method) {
      for (const std::string& stage : stages) sum += record.timings.value(stage, 0.0);
      ++count;
    }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

}  // namespace glint
