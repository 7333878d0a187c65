// SPDX-License-Identifier: MIT
#include "reports/verbs/dataset_parts.h"

#include "reports/verbs/load_options.h"

#include <memory>

#include "datasets/dataset.h"
#include "datasets/export/exporter.h"
#include "datasets/holdout.h"
#include "glint/core/error.h"
#include "glint/core/rows.h"
#include "metrics/tools/numeric_options.h"

namespace glint {

namespace {

struct ExportArguments {
  std::string folder, format, split = "all";
  LoadOptions load;  // loader, priors, size
  bool force = false;
};

ExportOptions export_options(const ExportArguments& arguments) {
  const std::map<std::string, ExportSplit> splits = {
      {"all", ExportSplit::kAll}, {"train", ExportSplit::kTrain}, {"test", ExportSplit::kTest}};
  return {arguments.format, splits.at(arguments.split), arguments.force};
}

void print_report(
    const CommonOptions& common, const std::string& format, const ExportReport& report
) {
  Rows parts({{"files"}, {"what"}});
  for (const ExportReport::Part& part : report.parts) parts.add({part.files, part.what});
  std::string text = fmt::format("{}: {}\n{}", common.out, format, parts.text());
  for (const std::string& note : report.notes) text += fmt::format("- {}\n", note);
  print_result(
      common,
      {{"folder", common.out},
       {"format", format},
       {"parts", parts.json()},
       {"notes", report.notes}},
      text
  );
}

int run_export(const CommonOptions& common, const ExportArguments& arguments, bool out_given) {
  GLINT_CHECK(out_given, kUsage, "dataset export: give --out FOLDER, where the export goes");
  const ExportOptions options = export_options(arguments);
  check_export(common.out, options);
  Scene scene = load_scene(arguments.folder, arguments.load);
  note_held_out(arguments.folder, scene);
  const ExportReport report = export_scene(scene, common.out, options);
  print_report(common, arguments.format, report);
  return 0;
}

std::string list_formats() {
  std::string text;
  for (const auto& [id, exporter] : Registry<ExporterSpec>::all())
    text += (text.empty() ? "" : ", ") + id;
  return text;
}

}  // namespace

void add_dataset_export(CommandLine& line, CLI::App& dataset) {
  auto arguments = std::make_shared<ExportArguments>();
  auto verb = std::make_shared<CLI::App*>(nullptr);
  *verb = line.add_verb(
      dataset,
      "export",
      "a scene as a folder that other programs train on (docs/guide/your_data.md)",
      [&line, arguments, verb] {
        return run_export(line.common, *arguments, (*verb)->count("--out") > 0);
      },
      kOutOption | kThreadsOption | kJsonOption | kQuietOption
  );
  CLI::App& app = **verb;
  describe_out(app, "folder of the export");
  app.add_option("folder", arguments->folder, "dataset folder or packed scene")->required();
  app.add_option("--format", arguments->format, "one of " + list_formats())->required();
  app.add_option("--split", arguments->split, "views that are written")
      ->check(CLI::IsMember({"all", "train", "test"}))
      ->capture_default_str();
  add_load_options(app, arguments->load);
  app.add_option("--max-pixels", arguments->load.max_pixels, "shrink images below this area")
      ->check(at_least_zero());
  app.add_flag("--force", arguments->force, "replace an earlier export in --out");
}

}  // namespace glint
