// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/interrupt.h"
#include "reports/bench/mesh_stage.h"
#include "reports/bench/run_stage.h"
#include "reports/bench/stage_documents.h"
#include "reports/verbs/single_run.h"

namespace glint {

namespace {

struct MeshArguments {
  std::string run;
  TsdfOptions options;
  bool keep_renders = false;
};

int run_mesh(const CommonOptions& common, const MeshArguments& arguments) {
  install_interrupt_handler();
  const SingleRun single = open_single_run(arguments.run);
  const auto method = load_trained(single.spec);
  const std::string& run = arguments.run;
  const std::string train_key = stage_key(finished_stage(run, Stage::kTrain, "train").document);
  Json result;
  run_stage(
      run,
      Stage::kMesh,
      mesh_document(single.spec.method, train_key, arguments.options),
      [&] {
        result = mesh_stage(
            single.spec, single.scene, *method, arguments.options, arguments.keep_renders
        );
        return std::string();
      }
  );
  if (common.json) {
    print_json(result);
    return 0;
  }
  for (const auto& [file, report] : result.at("meshes").items())
    print_text(fmt::format(
        "{}: {} triangles from {} training views, voxel {} m, {} of {} pieces dropped\n",
        (single.spec.folder / file).string(),
        report["triangles"].get<std::size_t>(),
        report["num_views"].get<std::size_t>(),
        arguments.options.voxel,
        report["dropped_clusters"].get<std::size_t>(),
        report["clusters"].get<std::size_t>()
    ));
  return 0;
}

void add_mesh_verb(CommandLine& line) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App* verb =
      line.add_verb(line.app, "mesh", "meshes of both layers of a trained run", [&line, arguments] {
        return run_mesh(line.common, *arguments);
      });
  verb->add_option("--run", arguments->run, "run folder")->required();
  TsdfOptions& options = arguments->options;
  verb->add_option("--voxel", options.voxel, "metres")->capture_default_str();
  verb->add_option("--truncation", options.truncation_voxels, "voxels")->capture_default_str();
  verb->add_option("--max-depth", options.max_depth, "metres; 0: the bounds' diagonal");
  verb->add_option("--min-cluster", options.min_cluster, "triangles")->capture_default_str();
  verb->add_option("--max-memory", options.max_memory_mb, "MB; 0: half of the machine's");
  verb->add_flag("--keep-renders", arguments->keep_renders, "leave renders_train/ for glint-tsdf");
}

}  // namespace

GLINT_REGISTER(Verb, {"mesh", add_mesh_verb})

}  // namespace glint
