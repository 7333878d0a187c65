// SPDX-License-Identifier: MIT
#include <memory>

#include "reports/show/tables/results_page.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

int run_results(const std::string& root) {
  const ResultsInfo info = read_results_info(results_parts(root).front());
  const auto records = read_records(fs::path(root) / info.records);
  GLINT_CHECK(!records.empty(), kBadPrediction, "{}: no records", info.records);
  const fs::path page = fs::path(root) / "docs/results/RESULTS.md",
                 readme = fs::path(root) / "README.md";
  write_file(page, results_markdown(root));
  write_file(readme, with_results(read_file(readme), readme_results(info, records)));
  print_text(fmt::format("{} and {}: written\n", page.string(), readme.string()));
  return 0;
}

void add_results_verb(CommandLine& line) {
  auto root = std::make_shared<std::string>(".");
  CLI::App* verb = line.add_verb(
      line.app,
      "results",
      "write docs/results/RESULTS.md and the README's table from docs/results/",
      [root] { return run_results(*root); },
      CommonOption{}
  );
  verb->add_option("--root", *root, "the project's folder")->capture_default_str();
}

}  // namespace

GLINT_REGISTER(Verb, {"results", add_results_verb})

}  // namespace glint
