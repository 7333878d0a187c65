// SPDX-License-Identifier: MIT
#include <memory>

#include "datasets/holdout.h"
#include "glint/core/progress.h"
#include "reports/verbs/dataset_parts.h"

namespace glint {

namespace {

struct HoldoutArguments {
  std::string folder, truth;
};

int run_holdout(const CommonOptions& common, const HoldoutArguments& arguments, bool out_given) {
  GLINT_CHECK(
      out_given,
      kUsage,
      "dataset holdout: give --out FOLDER, which everybody may have, and --truth FOLDER"
  );
  const HoldoutReport report = hold_out_truth({arguments.folder, common.out, arguments.truth});
  if (!report.warning.empty()) log::warn(report.warning);
  print_result(
      common,
      {{"folder", common.out},
       {"truth", arguments.truth},
       {"files", report.files_for_all},
       {"files_of_truth", report.files_to_score},
       {"test_views", report.test_views},
       {"warning", report.warning}},
      fmt::format(
          "{}: {} files for everybody\n{}: {} files, the truth of {} test views; put together "
          "(cp -r {}/. {}/. ROOM) they are the scene again\n",
          common.out,
          report.files_for_all,
          arguments.truth,
          report.files_to_score,
          report.test_views,
          common.out,
          arguments.truth
      )
  );
  return 0;
}

}  // namespace

void add_dataset_holdout(CommandLine& line, CLI::App& dataset) {
  auto arguments = std::make_shared<HoldoutArguments>();
  auto verb = std::make_shared<CLI::App*>(nullptr);
  *verb = line.add_verb(
      dataset,
      "holdout",
      "a scene in two folders: one for everybody, and its truth (docs/guide/submit.md)",
      [&line, arguments, verb] {
        return run_holdout(line.common, *arguments, (*verb)->count("--out") > 0);
      },
      kOutOption | kJsonOption | kQuietOption
  );
  CLI::App& app = **verb;
  describe_out(app, "new folder, which everybody may have");
  app.add_option("folder", arguments->folder, "of `dataset make`, or an export as easyvolcap")
      ->required();
  app.add_option("--truth", arguments->truth, "new folder for whoever scores")->required();
}

}  // namespace glint
