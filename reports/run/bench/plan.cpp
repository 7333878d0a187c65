// SPDX-License-Identifier: MIT
#include "reports/run/bench/plan.h"

#include "glint/core/nearest.h"
#include "glint/method.h"

namespace glint {

namespace {

// For a misspelt scene or method; `only`: what should be run, which --methods may add.
std::string hint_for(
    const Profile& profile, const std::vector<std::string>& patterns, bool only = true
) {
  std::vector<std::string> known = named_methods(profile.methods);
  for (const SceneSource& source : profile.sources()) known.push_back(source.scene);
  for (const std::string& pattern : patterns)
    if (const std::string nearest = nearest_word(pattern, known); !nearest.empty())
      return fmt::format("; did you mean '{}'?", nearest);
  return "; scenes and methods: " + comma_list(known) +
         (only ? "; a method that the profile does not name is run by --methods" : "");
}

// A pattern of cells without its seed, if it ends in one.
std::string without_seed(const std::string& pattern) {
  const std::size_t slash = pattern.rfind('/');
  const bool has_seed =
      slash != std::string::npos &&
      pattern.find_first_not_of("0123456789-*?[]", slash + 1) == std::string::npos;
  return has_seed ? pattern.substr(0, slash) : pattern;
}

// Does a pattern fit a scene, a method or a cell of these, of whatever seed?
bool fits_any(
    const std::string& pattern,
    const std::vector<SceneSource>& sources,
    const std::vector<std::string>& methods
) {
  const CellFilter filter{.only = {pattern, without_seed(pattern)}};
  for (const SceneSource& source : sources)
    for (const std::string& method : methods)
      if (filter_accepts(filter, {source.scene, method, 0})) return true;
  return false;
}

// A misspelt pattern would choose or leave out nothing without a word. `methods`: those that are
// run; the profile's others may be named, too.
void check_patterns(
    const Profile& profile, const CellFilter& filter, std::vector<std::string> methods
) {
  const std::vector<std::string> named = named_methods(profile.methods);
  methods.insert(methods.end(), named.begin(), named.end());
  const auto sources = profile.sources();
  const auto check = [&](const std::vector<std::string>& patterns, const std::string& where) {
    for (const std::string& pattern : patterns)
      GLINT_CHECK(
          fits_any(pattern, sources, methods),
          kUsage,
          "{} '{}' fits no scene, method or cell of profile {}{}",
          where,
          pattern,
          profile.name,
          hint_for(profile, {pattern}, where == "--only")
      );
  };
  check(filter.only, "--only");
  check(filter.skip, "--skip");
  check(profile.leave_out, "leave_out");
}

}  // namespace

std::vector<PlanCell> make_plan(
    const Profile& profile, const CellFilter& filter, const std::vector<std::string>& assignments
) {
  const auto methods = planned_methods(profile.methods, filter.methods);
  for (const auto& entry : profile.overrides.items())
    create_method(entry.key(), entry.value());  // also of those that are not run
  check_patterns(profile, filter, methods);
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
      hint_for(profile, filter.only)
  );
  return plan;
}

namespace {

// Of a record: what a training took that was stopped and went on is in its metrics, the timing is
// of the last process alone.
double seconds_of_stage(const Record& record, const std::string& stage) {
  const double timed = record.timings.value(stage, 0.0);
  const auto trained = record.metrics.find("train-minutes");
  const bool known = stage == "train" && trained != record.metrics.end();
  return known ? std::max(timed, 60 * trained->second) : timed;
}

}  // namespace

std::optional<double> estimated_seconds(
    const PlanCell& cell, const std::vector<Record>& records, const std::vector<std::string>& stages
) {
  double sum = 0;
  int count = 0;
  for (const Record& record : records)
    if (record.ok() && record.cell.method == cell.cell.method) {
      for (const std::string& stage : stages) sum += seconds_of_stage(record, stage);
      ++count;
    }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

}  // namespace glint
