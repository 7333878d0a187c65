// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <set>

#include "glint/core/nearest.h"
#include "glint/core/progress.h"
#include "metrics/tools/numeric_options.h"
#include "reports/show/tables/compare.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

struct CompareVerbOptions {
  std::string before, after;
  std::string markdown;  // file, or "-" for standard output
  CompareOptions compare;
};

// Every glob names a metric that either store has.
void check_metrics(const std::vector<Record>& records, const std::vector<std::string>& globs) {
  std::set<std::string> ids;
  for (const Record& record : records)
    for (const auto& [id, value] : record.metrics) ids.insert(id);
  const auto named = [&](const std::string& glob) {
    return std::any_of(ids.begin(), ids.end(), [&](const auto& id) {
      return glob_match(glob, id);
    });
  };
  const std::vector<std::string> known(ids.begin(), ids.end());
  for (const std::string& glob : globs)
    GLINT_CHECK(
        named(glob),
        kUsage,
        "--metric {}: neither store has such a metric; {}metrics: {}",
        glob,
        did_you_mean(glob, known),
        comma_list(known)
    );
}

int run_compare(const CommonOptions& common, const CompareVerbOptions& options) {
  const auto store = [&](const std::string& path) {
    return chosen_records(read_store(path), common.filter());
  };
  const std::vector<Record> before = store(options.before), after = store(options.after);
  std::vector<Record> both = before;
  both.insert(both.end(), after.begin(), after.end());
  check_metrics(both, options.compare.metrics);
  const Comparison comparison = compare_records(before, after, options.compare);
  const bool on_stdout = options.markdown == "-";
  if (!options.markdown.empty() && !on_stdout)
    write_file(options.markdown, comparison_markdown(comparison));
  print_result(
      common,
      comparison_json(comparison),
      on_stdout ? comparison_markdown(comparison) : comparison_text(comparison)
  );
  const bool compared = comparison.num_values > 0;
  if (!compared)
    log::warn(fmt::format(
        "nothing to compare: {} cells in common ({} only before, {} only after), no metric of both",
        comparison.num_cells,
        comparison.before_only.size(),
        comparison.after_only.size()
    ));
  const bool passed = compared && comparison.num_regressions() == 0;
  return static_cast<int>(passed ? ExitCode::kSuccess : ExitCode::kCheckFailed);
}

void add_compare_verb(CommandLine& line) {
  auto options = std::make_shared<CompareVerbOptions>();
  CLI::App* verb = line.add_verb(
      line.app,
      "compare",
      "what changed between two stores of records; exits with 4 on a regression, and where they "
      "have nothing in common",
      [&line, options] { return run_compare(line.common, *options); },
      kCellOptions | kJsonOption | kQuietOption
  );
  verb->add_option("before", options->before, "folder with records.jsonl, or the file")->required();
  verb->add_option("after", options->after, "the same, after the change")->required();
  verb->add_option(
          "--tolerance",
          options->compare.tolerance,
          "relative change that is no regression where there is one seed"
  )
      ->check(at_least_zero())
      ->capture_default_str();
  verb->add_option(
      "--metric",
      options->compare.metrics,
      "globs of metric ids, '*': all; none: the metrics of the tables"
  );
  verb->add_flag(
      "--costs", options->compare.costs, "slower, longer and larger is a regression, too"
  );
  verb->add_option(
      "--markdown", options->markdown, "write a Markdown table to FILE, '-': print it"
  );
}

}  // namespace

GLINT_REGISTER(Verb, {"compare", add_compare_verb})

}  // namespace glint
