// SPDX-License-Identifier: MIT
#include "metrics/tools/mesh.h"

#include <CLI/CLI.hpp>

#include <algorithm>

#include "datasets/released_truth.h"
#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "metrics/tools/mesh_output.h"
#include "metrics/tools/mesh_scoring.h"
#include "metrics/tools/numeric_options.h"
#include "metrics/tools/tool.h"

namespace glint {
namespace {

struct MeshToolOptions {
  fs::path prediction, reference, dataset, colored, colored_reference, curve;
  std::string cull, distance = "point-to-triangle", gltf_up = "y";
  MeshProtocol protocol;
  bool json = false, csv = false, quiet = false;
  int threads = 0;
};

void add_inputs(CLI::App& app, MeshToolOptions& options) {
  app.add_option(
         "PREDICTION",
         options.prediction,
         "mesh (.ply, .glb, .gltf, .obj, .stl) or points (.ply), or run folder: mesh.ply, by the "
         "protocol it was scored with"
  )
      ->required();
  app.add_option(
         "REFERENCE", options.reference, "mesh or points as well, or dataset folder: gt/mesh.ply"
  )
      ->required();
  app.add_option(
         "--cull",
         options.cull,
         "leave out what no training camera sees; cameras where a dataset is given"
  )
      ->check(CLI::IsMember({"cameras", "none"}));
  app.add_option("--dataset", options.dataset, "whose cameras cull; else REFERENCE's folder");
  app.add_option(
         "--gltf-up", options.gltf_up, "of glTF: axis that was up in the frame it was written from"
  )
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
}

void add_protocol(CLI::App& app, MeshToolOptions& options) {
  MeshProtocol& protocol = options.protocol;
  app.add_option("--tolerance", protocol.cull_tolerance_m, "of culling, metres (two voxels)")
      ->check(at_least_zero())
      ->capture_default_str();
  app.add_option(
         "--max-edge", protocol.cull_max_edge_m, "faces are split to it before culling, metres"
  )
      ->check(at_least_zero())
      ->capture_default_str();
  app.add_option("--samples", protocol.num_samples, "per surface")
      ->check(above_zero())
      ->capture_default_str();
  app.add_option("--seed", protocol.seed, "of the samples")->capture_default_str();
  app.add_option("--thresholds", protocol.thresholds_m, "of precision, recall and F1, metres")
      ->check(above_zero())
      ->capture_default_str();
  app.add_option("--distance", options.distance, "to the surface, or to its nearest sample")
      ->check(CLI::IsMember({"point-to-triangle", "point-to-point"}))
      ->capture_default_str();
  app.add_option("--max-distance", protocol.max_distance_m, "metres; clips what is further")
      ->check(above_zero());
}

void add_outputs(CLI::App& app, MeshToolOptions& options) {
  auto* json = app.add_flag("--json", options.json, "one JSON document, numbers not rounded");
  app.add_flag("--csv", options.csv, "one row, numbers not rounded")->excludes(json);
  app.add_option("--colored", options.colored, "FILE.ply: the prediction, distances as colours");
  app.add_option("--colored-reference", options.colored_reference, "FILE.ply: the reference");
  app.add_option(
      "--curve", options.curve, "FILE.png, and FILE.pdf beside it: F1 over the threshold"
  );
  app.add_option("--threads", options.threads, "0: all cores")->check(at_least_zero());
  app.add_flag("--quiet", options.quiet, "no progress on standard error");
}

void check_output(const fs::path& path, const char* option, const char* extension) {
  GLINT_CHECK(
      path.empty() || path.extension() == extension,
      kUsage,
      "{}: {}; expected a name that ends in {}",
      option,
      path.string(),
      extension
  );
}

// A folder of images and cameras that the reference may have come from.
fs::path dataset_of(const MeshToolOptions& options) {
  if (!options.dataset.empty() || !is_folder(options.reference)) return options.dataset;
  return options.reference;
}

// How a run's meshes were scored, as its metrics.json says; nothing of what is no scored run.
Json scored_protocol(const fs::path& run) {
  const fs::path file = run / "metrics.json";
  if (!is_file(file)) return Json::object();
  const Json scored = read_json_object(file, ExitCode::kBadPrediction);
  return scored.value(Json::json_pointer("/meshes/protocol"), Json::object());
}

// Of a scored run, so that the numbers are those of its tables, as far as options do not say
// otherwise. Errors (kUsage): fields of metrics.json that are none.
void take_scored_protocol(const CLI::App& app, MeshToolOptions& options) {
  Json fields = scored_protocol(options.prediction);
  if (!fields.is_object() || fields.empty()) return;
  for (const auto& [option, field] :
       {std::pair{"--tolerance", "cull_tolerance_m"},
        {"--max-edge", "cull_max_edge_m"},
        {"--samples", "num_samples"},
        {"--seed", "seed"},
        {"--thresholds", "thresholds_m"},
        {"--max-distance", "max_distance_m"}})
    if (app.get_option(option)->count() > 0) fields.erase(field);
  for (const char* of_options : {"distance", "cull"}) fields.erase(of_options);
  config_from_json(options.protocol, fields, (options.prediction / "metrics.json").string());
}

// Sets what follows from several options. Errors: kUsage.
void complete(MeshToolOptions& options) {
  check_output(options.colored, "--colored", ".ply");
  check_output(options.colored_reference, "--colored-reference", ".ply");
  check_output(options.curve, "--curve", ".png");
  options.dataset = dataset_of(options);
  GLINT_CHECK(
      options.cull != "cameras" || !options.dataset.empty(),
      kUsage,
      "--cull cameras needs the cameras: give --dataset, or a dataset folder as REFERENCE"
  );
  if (options.cull.empty()) options.cull = options.dataset.empty() ? "none" : "cameras";
  options.protocol.cull = Json(options.cull).get<MeshCulling>();
  options.protocol.distance = Json(options.distance).get<SurfaceDistance>();
  check_mesh_protocol(options.protocol);
}

// Of a dataset folder its true mesh.
fs::path reference_path(const fs::path& reference) {
  return surface_path(is_folder(reference) ? true_mesh(reference) : reference, kTrueMesh);
}

MeshReport load_surfaces(const MeshToolOptions& options) {
  MeshReport report;
  report.protocol = options.protocol;
  report.reference = read_surface(reference_path(options.reference));
  report.prediction = with_exit_code(ExitCode::kBadPrediction, [&] {
    return read_surface(surface_path(options.prediction, "mesh.ply"));
  });
  const GltfUp up = options.gltf_up == "z" ? GltfUp::kZ : GltfUp::kY;
  turn_gltf(report.prediction, up);
  turn_gltf(report.reference, up);
  report.warnings = frame_doubts(report.prediction, report.reference, up);
  for (const std::string& doubt : report.warnings) log::warn(doubt);
  for (const SurfaceInput* input : {&report.prediction, &report.reference})
    if (is_gltf(input->path)) report.gltf_up = options.gltf_up;
  return report;
}

void cull(MeshReport& report, const MeshToolOptions& options) {
  if (report.protocol.cull == MeshCulling::kNone) return;
  report.dataset = options.dataset;
  log::info(fmt::format("loading the cameras of {}", options.dataset.string()));
  cull_surfaces(report, training_cameras(options.dataset));
}

void check_outputs(const MeshReport& report, const MeshToolOptions& options) {
  for (const fs::path* output : {&options.colored, &options.colored_reference, &options.curve})
    for (const SurfaceInput* input : {&report.prediction, &report.reference})
      check_not_input(*output, input->path);
}

void write_pictures(MeshReport& report, const MeshToolOptions& options) {
  const Surface &prediction = report.prediction.surface, &reference = report.reference.surface;
  const double range = report.curve.back().threshold_m;
  if (!options.colored.empty()) write_colored(options.colored, prediction, reference, range);
  if (!options.colored_reference.empty())
    write_colored(options.colored_reference, reference, prediction, range);
  if (!options.colored.empty() || !options.colored_reference.empty()) report.color_range_m = range;
  if (!options.curve.empty()) write_drawing(options.curve, draw_f1_curve(report.curve));
}

void run(MeshToolOptions& options, std::ostream& out) {
  complete(options);
  set_quiet(options.quiet);
  if (options.threads > 0) set_num_threads(options.threads);
  MeshReport report = load_surfaces(options);
  check_outputs(report, options);
  cull(report, options);
  score_surfaces(report);
  write_pictures(report, options);
  if (options.json)
    print_mesh_json(report, out);
  else if (options.csv)
    print_mesh_csv(report, out);
  else
    print_mesh_text(report, out);
}

}  // namespace

int run_mesh_tool(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
  CLI::App app(
      "Distance of two surfaces in metres: Chamfer distance, precision, recall and F1, normal "
      "consistency.",
      "glint-mesh"
  );
  app.footer(
      "Examples:\n"
      "  glint-mesh out/ci/runs/room_1/2dgs/0 data/glassroom/room_1-*\n"
      "  glint-mesh predicted.ply scan.ply --thresholds 0.01 0.05 --curve f1.png --json\n"
  );
  MeshToolOptions options;
  add_inputs(app, options);
  add_protocol(app, options);
  add_outputs(app, options);
  return run_program(app, args, out, err, [&] {
    take_scored_protocol(app, options);
    run(options, out);
  });
}

}  // namespace glint
