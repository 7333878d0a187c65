// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "glint/core/printable.h"
#include "glint/core/progress.h"
#include "glint/scene/camera_path.h"
#include "metrics/tools/numeric_options.h"
#include "reports/run/bench/path_frames.h"
#include "reports/run/bench/video.h"
#include "reports/run/records/parcel_run.h"
#include "reports/verbs/single_cell.h"

namespace glint {

namespace {

constexpr int kDefaultFrames = 120;
constexpr double kDefaultFps = 24;

struct RenderArguments : NewCellOptions {  // run, dataset: also of runs of ours
  RenderArguments() { method = "model"; }

  // Of camera paths.
  std::string path, keys = "train", size, to;
  int frames = 0;  // 0: kDefaultFrames, or those of a file
  double fps = 0;  // 0: the file's, or kDefaultFps
  double radius = 0;
  std::vector<std::string> maps;
  bool values = false;
};

int render_test_views(const CommonOptions& common, const SingleCell& single) {
  render_stage(single.spec, single.scene, *load_trained(single.spec));
  const std::string renders = (single.spec.folder / "renders").string();
  if (common.json)
    print_json({{"renders", renders}, {"views", single.scene.test.size()}});
  else
    print_text(fmt::format("{}: {} test views\n", renders, single.scene.test.size()));
  return 0;
}

// "640x360"
ImageSize parse_size(const std::string& text) {
  int width = 0, height = 0;
  char rest = 0;
  const int read = std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest);
  GLINT_CHECK(
      read == 2 && width > 0 && height > 0 && width <= 16384 && height <= 16384,
      kUsage,
      "--size {}: expected WIDTHxHEIGHT in pixels, for example 640x360",
      text
  );
  return {width, height};
}

std::vector<Camera> cameras_of(const std::vector<View>& views) {
  std::vector<Camera> cameras;
  for (const View& view : views) cameras.push_back(view.camera);
  return cameras;
}

// Of a file. Errors: kUsage (no such file), those of read_camera_path.
CameraPath path_of_file(const RenderArguments& arguments, const Camera& lens) {
  const std::string& file = arguments.path;
  GLINT_CHECK(
      with_exit_code(ExitCode::kUsage, [&] { return is_file(file); }),
      kUsage,
      "--path {}: no such file; {}expected orbit, spline, or a file with cameras",
      file,
      did_you_mean(file, {"orbit", "spline"})
  );
  GLINT_CHECK(
      arguments.frames == 0, kUsage, "--frames is of orbit and spline; {} has its own frames", file
  );
  return read_camera_path(file, lens);
}

std::vector<Camera> path_cameras(const RenderArguments& arguments, const Scene& scene) {
  const std::vector<Camera> train = cameras_of(scene.train);
  const int frames = arguments.frames > 0 ? arguments.frames : kDefaultFrames;
  if (arguments.path == "spline")
    return CameraSpline(arguments.keys == "test" ? cameras_of(scene.test) : train).frames(frames);
  Orbit orbit = fit_orbit(train, cast<double>(scene.bounds_min), cast<double>(scene.bounds_max));
  if (arguments.radius > 0) orbit.radius = arguments.radius;
  return orbit_cameras(orbit, train.front(), frames);
}

CameraPath path_of(const RenderArguments& arguments, const Scene& scene) {
  GLINT_CHECK(!scene.train.empty(), kBadReference, "{}: no training view", scene.name);
  CameraPath path;
  if (arguments.path == "orbit" || arguments.path == "spline")
    path.cameras = path_cameras(arguments, scene);
  else
    path = path_of_file(arguments, scene.train.front().camera);
  if (!arguments.size.empty())
    for (Camera& camera : path.cameras) camera = with_size(camera, parse_size(arguments.size));
  if (arguments.fps > 0) path.fps = arguments.fps;
  if (path.fps <= 0) path.fps = kDefaultFps;
  return path;
}

void print_path(const CommonOptions& common, const PathFrames& options, const PathResult& result) {
  const fs::path sheets = options.folder / "layers/%04d.png", video = options.folder / "layers.mp4";
  std::string command;  // for a shell
  for (const std::string& word : video_command(sheets, options.path.fps, video))
    command += shell_word(word) + " ";
  if (common.json) {
    print_json(
        {{"folder", options.folder.string()},
         {"frames", result.frames},
         {"fps", options.path.fps},
         {"maps", result.maps},
         {"cameras", (options.folder / "path.json").string()},
         {"video", result.video.empty() ? Json() : Json(result.video.string())},
         {"why_no_video", result.no_video}}
    );
    return;
  }
  print_text(fmt::format(
      "{}: {} frames of {}, path.json with their cameras\n",
      options.folder.string(),
      result.frames,
      comma_list(result.maps)
  ));
  if (result.video.empty())
    print_text(fmt::format(
        "no video: {}. The frames side by side are in {}; to make one:\n  {}\n",
        result.no_video,
        sheets.parent_path().string(),
        command
    ));
  else
    print_text(fmt::format("{}: the layers side by side\n", result.video.string()));
}

int render_along_path(
    const CommonOptions& common, const RenderArguments& arguments, const SingleCell& single
) {
  PathFrames options;
  options.path = path_of(arguments, single.scene);
  options.folder = arguments.to.empty()
                       ? single.spec.folder / "paths" / fs::path(arguments.path).stem()
                       : fs::path(arguments.to);
  options.maps = arguments.maps;
  options.values = arguments.values;
  const auto method = load_trained(single.spec);
  print_path(common, options, render_path(*method, single.scene, options));
  return 0;
}

int run_render(const CommonOptions& common, const RenderArguments& arguments) {
  install_interrupt_handler();
  GLINT_CHECK(
      !arguments.model.empty() || !arguments.run.empty(),
      kUsage,
      "give --run FOLDER, or --model PLY --dataset FOLDER"
  );
  if (arguments.model.empty()) refuse_parcel_run(arguments.run, "render");
  const SingleCell single = arguments.model.empty()
                                ? open_single_cell(arguments.run, arguments.dataset)
                                : new_single_cell(common, arguments);
  try {
    return arguments.path.empty() ? render_test_views(common, single)
                                  : render_along_path(common, arguments, single);
  } catch (const Interrupted&) {
    log::warn("interrupted: not all is rendered");
    return interrupted_exit();
  }
}

void add_path_options(CLI::App& verb, RenderArguments& arguments) {
  auto* path = verb.add_option(
      "--path",
      arguments.path,
      "along a camera path instead: orbit, spline, or a file (path.json, transforms.json, "
      "nerfstudio's camera_path.json)"
  );
  const auto add = [&](const std::string& name, auto& value, const std::string& help) {
    return verb.add_option(name, value, help)->needs(path);
  };
  add("--frames", arguments.frames, "of orbit and spline; 120 if not given")->check(above_zero());
  add("--fps", arguments.fps, "frames a second of the video; the file's, or 24")
      ->check(above_zero());
  add("--size", arguments.size, "WIDTHxHEIGHT; the data's if not given");
  add("--keys", arguments.keys, "views that the spline passes through")
      ->check(CLI::IsMember({"train", "test"}))
      ->capture_default_str();
  add("--radius", arguments.radius, "of the orbit, metres; else the cameras' mean")
      ->check(above_zero());
  add("--maps",
      arguments.maps,
      "rgb,depth,..., and away: the glass taken away; all that there are if not given")
      ->delimiter(',');
  add("--to", arguments.to, "folder of the frames; RUN/paths/NAME if not given");
  verb.add_flag("--values", arguments.values, "EXR beside the pictures")->needs(path);
}

void add_model_options(CLI::App& verb, RenderArguments& arguments) {
  CLI::Option* model = verb.add_option(
      "--model",
      arguments.model,
      "Gaussians that another program trained: a PLY, or a folder (docs/guide/your_renders.md); "
      "becomes the "
      "run"
  );
  model->needs(verb.get_option("--dataset"));
  verb.add_option("--method", arguments.method, "row of the model in tables")
      ->needs(model)
      ->capture_default_str();
  verb.add_option(
          "--max-pixels", arguments.max_pixels, "of the model: shrink images below this area"
  )
      ->needs(model)
      ->check(at_least_zero());
  verb.add_flag("--force", arguments.force, "of the model: replace the run that is there")
      ->needs(model);
}

void add_render_verb(CommandLine& line) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "render",
      "render the test views of a trained run or of a model by another program, or a camera path",
      [&line, arguments] { return run_render(line.common, *arguments); },
      kWorkOptions | kOutOption | kDataOption | kSeedOption | kSetOption
  );
  verb->add_option("--run", arguments->run, "run folder; of --model: else OUT/single/runs/...");
  add_moved_dataset_option(*verb, arguments->dataset);
  add_model_options(*verb, *arguments);
  add_path_options(*verb, *arguments);
}

}  // namespace

GLINT_REGISTER(Verb, {"render", add_render_verb})

}  // namespace glint
