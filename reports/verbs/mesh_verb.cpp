// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/interrupt.h"
#include "metrics/tools/numeric_options.h"
#include "reports/run/bench/mesh_stage.h"
#include "reports/run/bench/voxel_choice.h"
#include "reports/verbs/single_cell.h"

namespace glint {

namespace {

struct MeshArguments {
  std::string run, dataset;
  double voxel = 0;  // 0: by choose_voxel
  TsdfOptions options;
  bool keep_renders = false;
};

VoxelChoice voxel_of(const MeshArguments& arguments, const Scene& scene) {
  if (arguments.voxel <= 0) return choose_voxel(scene);
  return {arguments.voxel, fmt::format("voxel {} m, as --voxel says", arguments.voxel)};
}

void print_meshes(const SingleCell& single, const Json& result) {
  for (const auto& [file, report] : result.at("meshes").items())
    print_text(fmt::format(
        "{}: {} triangles from {} training views, {} of {} pieces dropped\n",
        (single.spec.folder / file).string(),
        report["triangles"].get<std::size_t>(),
        report["num_views"].get<std::size_t>(),
        report["dropped_clusters"].get<std::size_t>(),
        report["clusters"].get<std::size_t>()
    ));
}

int run_mesh(const CommonOptions& common, const MeshArguments& arguments) {
  install_interrupt_handler();
  const SingleCell single = open_single_cell(arguments.run, arguments.dataset);
  const auto method = load_trained(single.spec);
  const VoxelChoice voxel = voxel_of(arguments, single.scene);
  TsdfOptions options = arguments.options;
  options.voxel = voxel.voxel;
  Json result = mesh_stage(single.spec, single.scene, *method, options, arguments.keep_renders);
  result["voxel_choice"] = voxel.why;
  if (common.json) {
    print_json(result);
    return 0;
  }
  print_text(voxel.why + "\n");
  print_meshes(single, result);
  return 0;
}

void add_mesh_verb(CommandLine& line) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App* verb = line.add_verb(
      line.app,
      "mesh",
      "meshes of both layers of a trained run",
      [&line, arguments] { return run_mesh(line.common, *arguments); },
      kWorkOptions
  );
  verb->add_option("--run", arguments->run, "run folder")->required();
  add_moved_dataset_option(*verb, arguments->dataset);
  TsdfOptions& options = arguments->options;
  verb->add_option(
          "--voxel",
          arguments->voxel,
          "metres; if not given, a pixel of the training views at the scene's usual depth"
  )
      ->check(above_zero());
  verb->add_option("--truncation", options.truncation_voxels, "voxels")->capture_default_str();
  verb->add_option("--max-depth", options.max_depth, "metres; 0: the bounds' diagonal");
  verb->add_option("--min-cluster", options.min_cluster, "triangles")->capture_default_str();
  verb->add_option("--max-memory", options.max_memory_mb, "MB; 0: half of the machine's");
  verb->add_flag("--keep-renders", arguments->keep_renders, "leave renders_train/ for glint-tsdf");
}

}  // namespace

GLINT_REGISTER(Verb, {"mesh", add_mesh_verb})

}  // namespace glint
