// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "reports/run/records/parcel_run.h"
#include "reports/show/tables/method_title.h"
#include "reports/verbs/open_viewer.h"
#include "reports/verbs/single_cell.h"

namespace glint {

namespace {

struct ViewArguments {
  std::vector<std::string> runs;
  std::string dataset;
  ViewerPlace place;
};

struct OpenedRun {
  std::string folder;
  std::unique_ptr<TemporaryFolder> temporary;  // of another program's model
  SingleCell single;
  std::unique_ptr<Method> method = load_trained(single.spec);
};

bool is_run(const std::string& path) {
  return with_exit_code(ExitCode::kBadPrediction, [&] {
    return is_there(fs::path(path) / "config.json");
  });
}

// A model of another program is read into a run of its own, which goes when the viewer does.
OpenedRun open_model(
    const CommonOptions& common, const std::string& path, const std::string& data
) {
  GLINT_CHECK(
      !data.empty(),
      kUsage,
      "{}: no run folder; for a model of another program say whose cameras it is seen by: "
      "--dataset FOLDER",
      path
  );
  auto temporary = std::make_unique<TemporaryFolder>("glint-view");
  NewCellOptions options;
  options.dataset = data;
  options.model = path;
  options.method = "model";
  options.run = (*temporary / "run").string();
  return {path, std::move(temporary), new_single_cell(common, options)};
}

OpenedRun open_one(const CommonOptions& common, const std::string& path, const std::string& data) {
  if (!is_run(path)) return open_model(common, path, data);
  refuse_parcel_run(path, "view");
  SingleCell single = open_single_cell(path, data);
  single.lock.reset();  // looking changes nothing
  return {path, nullptr, std::move(single)};
}

// Cameras and truth are those of one scene.
void check_one_scene(const std::vector<OpenedRun>& runs) {
  for (const OpenedRun& run : runs)
    GLINT_CHECK(
        run.single.scene.name == runs.front().single.scene.name &&
            run.single.scene.test.size() == runs.front().single.scene.test.size(),
        kUsage,
        "{} is of the scene {}, {} of {}: runs beside each other are of one scene; view them one "
        "by one",
        runs.front().folder,
        runs.front().single.scene.name,
        run.folder,
        run.single.scene.name
    );
}

ViewedRun viewed(const CommonOptions& common, OpenedRun& run) {
  const CellKey cell = run.single.spec.cell();
  const bool model = run.temporary != nullptr;
  ViewedRun::Names names{
      model ? fs::path(run.folder).filename().string()
            : fmt::format("{} (seed {})", cell.method, cell.seed),
      cell.method,
      model ? cell.method : method_title(cell.method),
      model ? fs::path(common.out) : fs::path(run.folder)};
  return ViewedRun(std::move(names), *run.method, run.single.scene, false);
}

int run_view(const CommonOptions& common, const ViewArguments& arguments) {
  install_interrupt_handler("the viewer ends");
  std::vector<OpenedRun> runs;
  for (const std::string& path : arguments.runs)
    runs.push_back(open_one(common, path, arguments.dataset));
  check_one_scene(runs);
  std::vector<ViewedRun> shown;
  for (OpenedRun& run : runs) shown.push_back(viewed(common, run));
  const auto viewer =
      open_viewer(common, arguments.place, runs.front().single.scene, std::move(shown), 0);
  log::info("Ctrl-C ends it");
  viewer->serve();
  return 0;
}

void add_view_verb(CommandLine& line) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "view",
      "walk through trained runs in a browser: all layers, two runs beside each other",
      [&line, arguments] { return run_view(line.common, *arguments); },
      kWorkOptions | kDataOption | kOutOption
  );
  verb->add_option("runs", arguments->runs, "run folders, or models of another program (--dataset)")
      ->required()
      ->expected(1, 8);
  verb->add_option(
      "--dataset", arguments->dataset, "of a model; of runs: where their data are now"
  );
  add_viewer_options(*verb, arguments->place);
}

}  // namespace

GLINT_REGISTER(Verb, {"view", add_view_verb})

}  // namespace glint
