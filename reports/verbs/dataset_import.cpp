// SPDX-License-Identifier: MIT
#include "reports/verbs/dataset_parts.h"

#include <memory>

#include "datasets/dataset.h"
#include "glint/core/error.h"
#include "glint/core/interrupt.h"
#include "glint/core/nearest.h"
#include "glint/core/progress.h"
#include "reports/run/import/import_photos.h"

namespace glint {

namespace {

struct ImportArguments {
  std::string photos;
  PhotoOptions options;
};

std::string model_text(const std::string& out, const PhotoModel& model) {
  std::string text = fmt::format(
      "{}: {} of {} photos have a camera, {} points ({} matching)\n",
      out,
      model.photos - model.unposed.size(),
      model.photos,
      model.points,
      model.matcher
  );
  if (model.masks > 0)
    text += fmt::format("- {} have masks of the pixels that count\n", model.masks);
  if (!model.unposed.empty())
    text += fmt::format("- left out, no place was found: {}\n", comma_list(model.unposed));
  if (model.other_models > 0)
    text += fmt::format(
        "- {} smaller models of photos that do not hang together with these\n", model.other_models
    );
  return text + "- the unit of length is COLMAP's, not metres: depths and meshes are relative\n";
}

void print_model(const CommonOptions& common, const PhotoModel& model) {
  print_result(
      common,
      {{"folder", common.out},
       {"photos", model.photos},
       {"unposed", model.unposed},
       {"points", model.points},
       {"masks", model.masks},
       {"other_models", model.other_models},
       {"matcher", model.matcher}},
      model_text(common.out, model)
  );
}

int run_import(const CommonOptions& common, ImportArguments arguments, bool out_given) {
  GLINT_CHECK(out_given, kUsage, "dataset import: give --out FOLDER, where the dataset goes");
  install_interrupt_handler();
  arguments.options.threads = common.threads;
  try {
    print_model(common, import_photos(arguments.photos, common.out, arguments.options));
  } catch (const Interrupted&) {
    log::warn("interrupted; the same command goes on");
    return interrupted_exit();
  }
  for (const Finding& finding : check_dataset(common.out))
    log::warn(fmt::format("{}: {}: {}", finding.check, finding.where, finding.message));
  log::info(fmt::format("next: glint-bench train --dataset {} --method 2dgs", common.out));
  return 0;
}

}  // namespace

void add_dataset_import(CommandLine& line, CLI::App& dataset) {
  auto arguments = std::make_shared<ImportArguments>();
  auto verb = std::make_shared<CLI::App*>(nullptr);
  *verb = line.add_verb(
      dataset,
      "import",
      "photos without cameras as a dataset, by COLMAP where it is installed",
      [&line, arguments, verb] {
        return run_import(line.common, *arguments, (*verb)->count("--out") > 0);
      },
      kOutOption | kThreadsOption | kJsonOption | kQuietOption
  );
  CLI::App& app = **verb;
  describe_out(app, "folder of the dataset");
  PhotoOptions& options = arguments->options;
  app.add_option("photos", arguments->photos, "folder with photos")->required();
  app.add_option("--lens", options.lens, "camera model, of one lens where all sizes are the same")
      ->check(CLI::IsMember({"SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV"}))
      ->capture_default_str();
  app.add_option("--matcher", options.matcher, "pairs of photos that are compared")
      ->check(CLI::IsMember({"auto", "exhaustive", "sequential"}))
      ->capture_default_str();
  app.add_option(
      "--masks", options.masks, "folder with masks of the photos: what is black does not count"
  );
  app.add_option("--max-side", options.max_side, "pixels of the photos that features are found in")
      ->check(CLI::Range(100, 20000))
      ->capture_default_str();
}

}  // namespace glint
