// SPDX-License-Identifier: MIT
#include "reports/show/figures/figures.h"
#include "reports/verbs/report_verb.h"

namespace glint {

namespace {

std::vector<fs::path> written_figures(
    const CommonOptions& common, const FigureView& shown, const std::vector<std::string>& runs
) {
  if (runs.empty())
    return write_figures({folder_with_records(common), load_run_data, common.methods, shown});
  return write_growth({runs, fs::path(common.out) / "figures", common.methods, shown.scenes});
}

int run_figures(
    const CommonOptions& common, const FigureView& shown, const std::vector<std::string>& runs
) {
  Json json = {{"figures", Json::array()}};
  for (const fs::path& path : written_figures(common, shown, runs)) {
    json["figures"].push_back(path.string());
    if (!common.json) print_text(path.string() + "\n");
  }
  if (common.json) print_json(json);
  return 0;
}

void add_figures_verb(CommandLine& line) {
  const auto shown = std::make_shared<FigureView>();
  const auto runs = std::make_shared<std::vector<std::string>>();
  CLI::App* verb = line.add_verb(
      line.app,
      "figures",
      "write OUT/PROFILE/figures/*.png and *.pdf",
      [&line, shown, runs] { return run_figures(line.common, *shown, *runs); },
      kFolderOptions | kThreadsOption
  );
  verb->add_option(
      "--runs", *runs, "run folders, or folders above: only OUT/figures/growth.png, of their logs"
  );
  verb->add_option("--scene", shown->scenes, "globs of the scenes to show")->delimiter(',');
  verb->add_option("--view", shown->view, "name of the test view to show");
  verb->add_option(
      "--crop", shown->crops, "x,y,width,height of a closer look, pixels of the view; up to three"
  );
}

}  // namespace

GLINT_REGISTER(Verb, {"figures", add_figures_verb})

}  // namespace glint
