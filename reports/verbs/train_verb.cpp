// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "metrics/tools/numeric_options.h"
#include "reports/verbs/open_viewer.h"

namespace glint {

namespace {

// Empty where none was.
std::string void_steps_text(const Json& steps) {
  if (steps.at("count") == 0) return "";
  return fmt::format(
      ", {} steps left out for want of room, the last at iteration {}",
      steps.at("count").get<int>(),
      steps.at("last").get<int>()
  );
}

struct TrainArguments : NewCellOptions {
  std::string transmission;
  bool view = false;
  ViewerPlace place;
};

int run_train(CommonOptions common, const TrainArguments& options) {
  if (!options.transmission.empty()) common.set.push_back("transmission=" + options.transmission);
  install_interrupt_handler();
  const SingleCell single = new_single_cell(common, options);
  const std::string folder = single.spec.folder.string();
  try {
    const AfterStep watched =
        options.view ? watch_training(common, options.place, single) : AfterStep();
    const auto method = train_stage(single.spec, single.scene, watched);
    const TrainCost cost = trained_cost(single.spec).value();
    if (common.json)
      print_json(
          {{"run", folder},
           {"num_surfels", method->num_surfels()},
           {"train_seconds", cost.seconds},
           {"peak_memory_mb", cost.peak_memory_mb},
           {"device_memory_mb", cost.device_memory_mb},
           {"void_steps", cost.void_steps}}
      );
    else
      print_text(fmt::format(
          "{}: {} surfels in {}{}\n",
          folder,
          method->num_surfels(),
          format_duration(cost.seconds),
          void_steps_text(cost.void_steps)
      ));
  } catch (const Interrupted&) {
    log::warn("interrupted: " + folder + " is not complete; the same command goes on");
    return interrupted_exit();
  }
  log::info(fmt::format(
      "not in any records yet; next: glint-bench render --run {0}, then eval --run {0}, which "
      "records it",
      folder
  ));
  return 0;
}

void add_train_verb(CommandLine& line) {
  auto options = std::make_shared<TrainArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "train",
      "train one method on one dataset",
      [=, &line] { return run_train(line.common, *options); },
      kWorkOptions | kOutOption | kDataOption | kSeedOption | kIterationsOption | kSetOption |
          kCheckpointOption
  );
  verb->add_option("--dataset", options->dataset, "dataset folder or packed scene")->required();
  verb->add_option("--method", options->method, "method id")->capture_default_str();
  verb->add_option("--run", options->run, "run folder; else OUT/single/runs/SCENE/METHOD/SEED");
  verb->add_option("--transmission", options->transmission, "glint: raster or trace")
      ->check(CLI::IsMember({"raster", "trace"}));
  verb->add_flag("--force", options->force, "train again in a folder that holds a run");
  verb->add_option("--max-pixels", options->max_pixels, "shrink images below this area")
      ->check(at_least_zero());
  verb->add_option(
          "--image-ratio", options->image_ratio, "shrink both sides of images to this share"
  )
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1.0))
      ->excludes("--max-pixels");
  CLI::Option* view =
      verb->add_flag("--view", options->view, "watch it in a browser while it goes on");
  add_viewer_options(*verb, options->place, view);
}

}  // namespace

GLINT_REGISTER(Verb, {"train", add_train_verb})

}  // namespace glint
