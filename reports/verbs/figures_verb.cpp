// SPDX-License-Identifier: MIT
#include "reports/figures/figures.h"
#include "reports/verbs/report_verb.h"

namespace glint {

namespace {

int run_figures(const CommonOptions& common, const std::vector<std::string>& methods) {
  const fs::path folder = folder_with_records(common);
  Json json = {{"figures", Json::array()}};
  for (const fs::path& path : write_figures({folder, load_run_data, methods})) {
    json["figures"].push_back(path.string());
    if (!common.json) print_text(path.string() + "\n");
  }
  if (common.json) print_json(json);
  return 0;
}

void add_figures_verb(CommandLine& line) {
  const auto methods = std::make_shared<std::vector<std::string>>();
  CLI::App* verb = line.add_verb(
      line.app,
      "figures",
      "write OUT/PROFILE/figures/*.png and *.pdf",
      [&line, methods] { return run_figures(line.common, *methods); },
      kFolderOptions | kThreadsOption
  );
  verb->add_option(
          "--methods", *methods, "globs of the methods to show, such as 2dgs,glint,*/prior"
  )
      ->delimiter(',');
}

}  // namespace

GLINT_REGISTER(Verb, {"figures", add_figures_verb})

}  // namespace glint
