// SPDX-License-Identifier: MIT
#include "reports/run/selftest/conformance.h"

#include <cmath>
#include <set>

#include "glint/core/presence.h"
#include "reports/run/selftest/programs.h"

namespace glint {
namespace {

VectorResult judged(const ConformanceVector& vector, double found) {
  const bool good = std::abs(found - vector.expected) <= vector.tolerance;
  return {vector, good ? VectorStatus::kPassed : VectorStatus::kFailed, found, ""};
}

VectorResult skipped(const ConformanceVector& vector, const std::string& why) {
  return {vector, VectorStatus::kSkipped, 0, why};
}

// Arguments that name a file or folder of the vectors become its path.
std::vector<std::string> located(
    const std::vector<std::string>& arguments, const fs::path& folder
) {
  std::vector<std::string> result = arguments;
  for (std::size_t i = 1; i < result.size(); ++i)
    if (is_there(folder / result[i])) result[i] = (folder / result[i]).string();
  return result;
}

VectorResult judged(const ConformanceVector& vector, const ProgramResult& result) {
  if (result.exit_code == ExitCode::kEnvironment) return skipped(vector, result.message);
  if (result.exit_code != ExitCode::kSuccess)
    return {vector, VectorStatus::kFailed, std::nan(""), result.message};
  const auto found = result.values.find(vector.value);
  if (found == result.values.end())
    return {vector, VectorStatus::kFailed, std::nan(""), "prints no " + vector.value};
  return judged(vector, found->second);
}

}  // namespace

void export_conformance(const fs::path& folder) {
  for (const auto& [path, bytes] : conformance_files()) write_file(folder / path, bytes);
}

std::vector<ConformanceVector> read_vectors(const fs::path& folder) {
  const std::string where = (folder / "vectors.json").string();
  const Json json = read_json_object(where);
  GLINT_CHECK(
      json.contains("vectors") && json["vectors"].is_array(),
      kBadReference,
      "{}: no list 'vectors'",
      where
  );
  std::vector<ConformanceVector> vectors;
  std::set<std::string> ids;
  for (const Json& entry : json["vectors"]) {
    ConformanceVector vector;
    with_exit_code(ExitCode::kBadReference, [&] { config_from_json(vector, entry, where); });
    GLINT_CHECK(
        !vector.arguments.empty() && ids.insert(vector.id).second,
        kBadReference,
        "{}: vector '{}' has no arguments, or stands there twice",
        where,
        vector.id
    );
    vectors.push_back(vector);
  }
  return vectors;
}

std::vector<VectorResult> run_vectors(
    const std::vector<ConformanceVector>& vectors, const fs::path& folder
) {
  std::map<std::vector<std::string>, ProgramResult> done;
  std::vector<VectorResult> results;
  for (const ConformanceVector& vector : vectors) {
    auto entry = done.find(vector.arguments);
    if (entry == done.end())
      entry = done.emplace(vector.arguments, run_scorer(located(vector.arguments, folder))).first;
    results.push_back(judged(vector, entry->second));
  }
  return results;
}

std::vector<VectorResult> check_values(
    const std::vector<ConformanceVector>& vectors, const Json& values
) {
  std::vector<VectorResult> results;
  for (const ConformanceVector& vector : vectors) {
    const auto found = values.find(vector.id);
    results.push_back(
        found != values.end() && found->is_number() ? judged(vector, found->get<double>())
                                                    : skipped(vector, "no value given")
    );
  }
  return results;
}

}  // namespace glint
