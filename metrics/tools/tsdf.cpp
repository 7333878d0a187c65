// SPDX-License-Identifier: MIT
#include "metrics/tools/tsdf.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <ostream>

#include "datasets/dataset.h"
#include "glint/core/parallel.h"
#include "glint/core/presence.h"
#include "glint/core/printable.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_depth.h"
#include "glint/scene/image_files_stored.h"
#include "glint/scene/ply.h"
#include "metrics/fusion/tsdf.h"
#include "metrics/tools/numeric_options.h"
#include "metrics/tools/pairing.h"
#include "metrics/tools/tool.h"
#include "metrics/tools/tool_output.h"

namespace glint {
namespace {

struct TsdfArguments {
  std::string depth, dataset, out = "mesh.ply", map = "depth.exr", pattern, mask;
  TsdfOptions options;
  std::vector<double> bounds;
  double depth_scale = 0;  // metres; 0: not given
  bool ray = false, json = false, csv = false, quiet = false;
  int threads = 0;
};

void add_options(CLI::App& app, TsdfArguments& a) {
  app.add_option(
         "DEPTH", a.depth, "folder with a depth map per view, or glob: planar z, EXR, NPY or PNG"
  )
      ->required();
  app.add_option("DATASET", a.dataset, "dataset folder: cameras of the views by name")->required();
  app.add_option("--out,-o", a.out, "mesh to write")->capture_default_str();
  app.add_option("--map", a.map, "file in a view's folder")->capture_default_str();
  app.add_option("--pattern", a.pattern, "which files of a folder, e.g. '*_depth.exr'");
  app.add_option("--mask", a.mask, "depths that count: image, or folder with one per name");
  TsdfOptions& o = a.options;
  app.add_option("--voxel", o.voxel, "metres")->capture_default_str();
  app.add_option("--truncation", o.truncation_voxels, "in voxels")->capture_default_str();
  app.add_option("--max-depth", o.max_depth, "metres; 0: the bounds' diagonal");
  app.add_option("--bounds", a.bounds, "X0 Y0 Z0 X1 Y1 Z1 in metres; otherwise none")->expected(6);
  app.add_option("--min-cluster", o.min_cluster, "triangles")->capture_default_str();
  app.add_option("--max-memory", o.max_memory_mb, "MB; 0: half of the machine's");
  app.add_option("--depth-scale", a.depth_scale, "metres of a step of integers (0.001: mm)")
      ->check(above_zero());
  app.add_flag("--ray", a.ray, "the maps hold distances along rays");
  auto* json = app.add_flag("--json", a.json, "one JSON document");
  app.add_flag("--csv", a.csv, "one row")->excludes(json);
  app.add_option("--threads", a.threads, "0: all cores")->check(at_least_zero());
  app.add_flag("--quiet", a.quiet, "no progress on standard error");
  app.footer("Example:\n  glint-tsdf renders/ rooms/room_3 --voxel 0.02 --out mesh.ply\n");
}

// A depth map, the camera of its name, and the picture beside it where there is one.
struct Source {
  fs::path depth, rgb, mask;
  Camera camera;
};

std::map<std::string, Camera> cameras_by_name(const Scene& scene) {
  std::map<std::string, Camera> cameras;
  for (const auto* views : {&scene.train, &scene.test})
    for (const View& view : *views) cameras[flat_view_name(view.name)] = view.camera;
  return cameras;
}

fs::path picture_beside(const fs::path& depth) {
  for (const char* name : {"rgb.png", "rgb.exr"})
    if (is_there(depth.parent_path() / name)) return depth.parent_path() / name;
  return {};
}

std::vector<Source> find_sources(const TsdfArguments& a, const Scene& scene) {
  const auto cameras = cameras_by_name(scene);
  const MaskFiles masks(a.mask, mask_layout());
  std::vector<Source> sources;
  const auto files = with_exit_code(ExitCode::kBadPrediction, [&] {
    return list_inputs(a.depth, {{"renders_train", "renders"}, {a.map}}, a.pattern);
  });
  for (const NamedFile& file : files) {
    const auto camera = cameras.find(file.name);
    GLINT_CHECK(
        camera != cameras.end(),
        kBadPrediction,
        "{}: {} has no view '{}'; name depth maps as views ('{}', ...)",
        file.path.string(),
        a.dataset,
        file.name,
        cameras.begin()->first
    );
    sources.push_back({file.path, picture_beside(file.path), masks.of(file.name), camera->second});
  }
  return sources;
}

// Of integers; nothing of floats.
DepthSteps scale_of(const fs::path& depth, double stated) {
  return with_exit_code(ExitCode::kBadPrediction, [&]() -> DepthSteps {
    if (!stores_integers(depth)) return {};
    if (stated > 0) return {stated, "--depth-scale"};
    return exported_depth_scale(depth);
  });
}

// Maps of another size than the dataset's images bring their own resolution.
FusionView load_source(const Source& source, const TsdfArguments& a, const DepthSteps& scale) {
  FusionView view = with_exit_code(ExitCode::kBadPrediction, [&] {
    FusionView read{read_depth(source.depth, scale), {}, source.camera};
    read.camera = resized(source.camera, read.depth.size());
    if (a.ray) make_planar(read.depth, read.camera);
    if (!source.rgb.empty()) read.rgb = read_image(source.rgb, 3);
    return read;
  });
  const MaskImage mask = load_mask(source.mask, view.depth.size());
  for (std::size_t i = 0; i < mask.num_pixels(); ++i)
    if (mask.data()[i] == 0) view.depth.data()[i] = 0;
  return view;
}

void print_csv(const std::string& mesh, const Json& report, std::ostream& out) {
  out << "mesh";
  for (const auto& [name, value] : report.items()) out << "," << name;
  out << "\n" << csv_field(mesh);
  for (const auto& [name, value] : report.items()) out << "," << value.dump();
  out << "\n";
}

void print_report(
    const TsdfArguments& a, const DepthSteps& scale, const TsdfReport& report, std::ostream& out
) {
  if (a.json) {
    Json json = {{"tool", "glint-tsdf"}, {"depth", a.depth}, {"dataset", a.dataset}};
    if (!a.mask.empty()) json["mask"] = a.mask;
    json["mesh"] = a.out;
    json["options"] = config_to_json(a.options);
    if (scale.known()) json["steps"] = {{"metres", scale.metres}, {"from", scale.from}};
    json["report"] = config_to_json(report);
    out << json.dump(2) << "\n";
    return;
  }
  if (a.csv) return print_csv(a.out, config_to_json(report), out);
  out << fmt::format(
      "{}: {} triangles from {} views, voxel {} m, truncation {} voxels, {} of {} pieces dropped, "
      "{:.0f} MB of memory\n",
      a.out,
      report.triangles,
      report.num_views,
      a.options.voxel,
      a.options.truncation_voxels,
      report.dropped_clusters,
      report.clusters,
      report.memory_mb
  );
}

// A file of the dataset, such as its true mesh, is not what a mesh is written over.
bool lies_in(const fs::path& file, const fs::path& folder) {
  std::error_code code;
  const fs::path inside =
      fs::weakly_canonical(file, code).lexically_relative(fs::weakly_canonical(folder, code));
  return !inside.empty() && *inside.begin() != "..";
}

void check_destination(const TsdfArguments& a, const std::vector<Source>& sources) {
  const fs::path out = a.out;
  GLINT_CHECK(out.extension() == ".ply", kUsage, "{}: a mesh is written as .ply", a.out);
  for (const Source& source : sources)
    for (const fs::path& input : {source.depth, source.rgb, source.mask})
      check_not_input(out, input);
  GLINT_CHECK(
      !is_there(out) || !lies_in(out, a.dataset),
      kUsage,
      "{}: is a file of the dataset {}; name another file to write",
      a.out,
      a.dataset
  );
}

void run(TsdfArguments& a, std::ostream& out) {
  set_quiet(a.quiet);
  if (a.threads > 0) set_num_threads(a.threads);
  if (!a.bounds.empty()) {
    std::copy_n(a.bounds.begin(), 3, a.options.bounds_min.begin());
    std::copy_n(a.bounds.begin() + 3, 3, a.options.bounds_max.begin());
  }
  LoadOptions load;
  load.with_truth = load.with_priors = false;
  const std::vector<Source> sources = find_sources(a, load_scene(a.dataset, load));
  check_destination(a, sources);
  TsdfReport report;
  const DepthSteps scale = scale_of(sources.front().depth, a.depth_scale);
  const auto view = [&](std::size_t i) { return load_source(sources[i], a, scale); };
  write_mesh_ply(a.out, fuse_depth(view, sources.size(), a.options, &report));
  print_report(a, scale, report, out);
}

}  // namespace

int run_tsdf_program(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
  CLI::App app("A mesh from depth maps: Open3D's TSDF and marching cubes.", "glint-tsdf");
  TsdfArguments arguments;
  add_options(app, arguments);
  return run_program(app, args, out, err, [&] { run(arguments, out); });
}

}  // namespace glint
