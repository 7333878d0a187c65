// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include "glint/core/progress.h"
#include "reports/selftest/conformance.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

struct SelftestArguments {
  std::string export_to, vectors, check;
};

std::size_t count(const std::vector<VectorResult>& results, VectorStatus status) {
  return static_cast<std::size_t>(std::count_if(
      results.begin(),
      results.end(),
      [&](const VectorResult& result) { return result.status == status; }
  ));
}

void print_results(const std::vector<VectorResult>& results) {
  std::vector<std::vector<std::string>> rows = {
      {"vector", "", "found", "expected", "tolerance", "made by", "convention"}};
  for (const VectorResult& result : results) {
    const ConformanceVector& vector = result.vector;
    const bool ran = result.status != VectorStatus::kSkipped;
    rows.push_back(
        {vector.id,
         Json(result.status).get<std::string>(),
         ran ? fmt::format("{:.6f}", result.found) : "-",
         fmt::format("{:.6f}", vector.expected),
         fmt::format("{:g}", vector.tolerance),
         vector.source,
         result.note.empty() ? vector.convention : result.note.substr(0, result.note.find('\n'))}
    );
  }
  print_text(aligned_rows(rows, {0, 1, 5, 6}));
  print_text(fmt::format(
      "{} passed, {} failed, {} skipped\n",
      count(results, VectorStatus::kPassed),
      count(results, VectorStatus::kFailed),
      count(results, VectorStatus::kSkipped)
  ));
}

Json results_json(const std::vector<VectorResult>& results) {
  Json json = Json::array();
  for (const VectorResult& result : results) {
    Json entry = config_to_json(result.vector);
    entry["status"] = result.status;
    if (result.status != VectorStatus::kSkipped) entry["found"] = result.found;
    if (!result.note.empty()) entry["note"] = result.note;
    json.push_back(entry);
  }
  return {{"vectors", json}};
}

int run_selftest(const CommonOptions& common, const SelftestArguments& arguments) {
  if (!arguments.export_to.empty()) {
    export_conformance(arguments.export_to);
    print_text(fmt::format(
        "{}: {} files; vectors.json lists commands and values\n",
        arguments.export_to,
        conformance_files().size()
    ));
    return 0;
  }
  const TemporaryFolder own("glint_vectors");
  const fs::path folder = arguments.vectors.empty() ? own.path() : fs::path(arguments.vectors);
  if (arguments.vectors.empty()) export_conformance(folder);
  const auto vectors = read_vectors(folder);
  const auto results =
      arguments.check.empty()
          ? run_vectors(vectors, folder)
          : check_values(vectors, read_json_object(arguments.check, ExitCode::kBadPrediction));
  if (common.json)
    print_json(results_json(results));
  else
    print_results(results);
  const bool failed = count(results, VectorStatus::kFailed) > 0;
  return static_cast<int>(failed ? ExitCode::kCheckFailed : ExitCode::kSuccess);
}

void add_selftest_verb(CommandLine& line) {
  auto arguments = std::make_shared<SelftestArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "selftest",
      "score shipped files and compare with values by other software",
      [&line, arguments] { return run_selftest(line.common, *arguments); },
      kDeviceOption | kThreadsOption | kJsonOption | kQuietOption
  );
  verb->add_option("--export", arguments->export_to, "write the files there and stop");
  verb->add_option("--vectors", arguments->vectors, "a folder like the exported one");
  verb->add_option(
      "--check", arguments->check, "JSON of another implementation: vector id -> its value"
  );
}

}  // namespace

GLINT_REGISTER(Verb, {"selftest", add_selftest_verb})

}  // namespace glint
