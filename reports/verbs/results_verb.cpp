// SPDX-License-Identifier: MIT
#include <map>
#include <memory>

#include "reports/show/page/results_html.h"
#include "reports/show/tables/results_page.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

int run_results(const std::string& root) {
  const ResultsInfo info = read_results_info(results_parts(root).front());
  const auto records = read_records(fs::path(root) / info.records);
  GLINT_CHECK(!records.empty(), kBadPrediction, "{}: no records", info.records);
  const fs::path folder = root, readme = folder / "README.md";
  const std::map<fs::path, std::string> files{
      {folder / "docs/results/RESULTS.md", results_markdown(folder)},
      {folder / kResultsPage, results_html(folder)},
      {folder / kOrderFigure, order_figure(order_by_length(folder))},
      {readme, with_results(read_file(readme), readme_results(info, records))}};
  for (const auto& [file, text] : files) {
    write_file(file, text);
    print_text(fmt::format("{}: written\n", file.string()));
  }
  return 0;
}

void add_results_verb(CommandLine& line) {
  auto root = std::make_shared<std::string>(".");
  CLI::App* verb = line.add_verb(
      line.app,
      "results",
      "write docs/results/RESULTS.md, its page index.html and the README's table from "
      "docs/results/",
      [root] { return run_results(*root); },
      CommonOption{}
  );
  verb->add_option("--root", *root, "the project's folder")->capture_default_str();
}

}  // namespace

GLINT_REGISTER(Verb, {"results", add_results_verb})

}  // namespace glint
