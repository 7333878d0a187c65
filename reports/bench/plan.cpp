// SPDX-License-Identifier: MIT
#include "reports/bench/plan.h"

#include "glint/method.h"

namespace glint {

std::vector<PlanCell> make_plan(
    const Profile& profile, const CellFilter& filter, const std::vector<std::string>& assignments
) {
  const auto methods = planned_methods(profile.methods, filter.methods);
  std::vector<PlanCell> plan;
  for (const SceneSource& source : profile.sources())
    for (const std::string& method : methods)
      for (const std::uint64_t seed : profile.seeds) {
        PlanCell cell{{source.scene, method, seed}, source, {}};
        if (!filter_accepts(filter, cell.cell)) continue;
        cell.config = method_overrides(profile, method, assignments);
        create_method(method, cell.config);  // unknown methods and fields stop here
        plan.push_back(std::move(cell));
      }
  GLINT_CHECK(
      !plan.empty(),
      kUsage,
      "no cell left: profile {} has {} scenes and {} methods, none passes --only and --skip; "
      "a method that the profile does not name is run by --methods",
      profile.name,
      profile.scenes.size(),
      methods.size()
  );
  return plan;
}

double estimated_seconds(
    const PlanCell& cell, const std::vector<Record>& records, const std::vector<std::string>& stages
) {
  double sum = 0;
  int count = 0;
  for (const Record& record : records)
    if (record.ok() && record.cell.method == cell.cell.method) {
      for (const std::string& stage : stages) sum += record.timings.value(stage, 0.0);
      ++count;
    }
  return count > 0 ? sum / count : 0;
}

}  // namespace glint
