// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "reports/run/selftest/conformance.h"
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

Rows rows_of(const std::vector<VectorResult>& results) {
  Rows rows(
      {{"id", "vector"},
       {"status", ""},
       {"found", "found", "{:.6f}"},
       {"expected", "expected", "{:.6f}"},
       {"tolerance", "tolerance", "{:g}"},
       {"source", "made by"},
       {"", "convention"}},
      "arguments value convention note"
  );
  for (const auto& [vector, status, found, note] : results)
    rows.add(
        {vector.id,
         status,
         status == VectorStatus::kSkipped ? Cell(Json(Json::value_t::discarded), "-") : found,
         vector.expected,
         vector.tolerance,
         vector.source,
         note.empty() ? vector.convention : note.substr(0, note.find('\n')),
         vector.arguments,
         vector.value,
         vector.convention,
         note.empty() ? Cell::absent() : note}
    );
  return rows;
}

std::string counts_text(const std::vector<VectorResult>& results) {
  return fmt::format(
      "{} passed, {} failed, {} skipped\n",
      count(results, VectorStatus::kPassed),
      count(results, VectorStatus::kFailed),
      count(results, VectorStatus::kSkipped)
  );
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
  const Rows rows = rows_of(results);
  print_result(common, {{"vectors", rows.json()}}, rows.text() + counts_text(results));
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
