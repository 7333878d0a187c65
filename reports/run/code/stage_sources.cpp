// SPDX-License-Identifier: MIT
#include "reports/run/code/stage_sources.h"

namespace glint {

const std::vector<StageSources>& stage_sources() {
  static const std::vector<StageSources> all = {
      {"make", {"datasets/glassroom/*.cpp"}},
      {"front3d", {"datasets/front3d/*.cpp"}},
      {"load", {"datasets/dataset.h", "reports/run/records/scene_source.cpp"}},
      {"cuda", {"glint/cuda/*"}},
      {"model", {"glint/scene/gaussian_ply.h", "reports/run/import/import_model.cpp"}},
      {"render",
       {"glint/method.h",
        "glint/scene/image_files.h",
        "reports/run/bench/stages.cpp",
        "reports/run/records/run_folder.cpp"}},
      {"mesh",
       {"glint/scene/image_files.h",
        "glint/scene/ply.h",
        "metrics/fusion/*.cpp",
        "reports/run/bench/fuse_stage.cpp",
        "reports/run/bench/mesh_stage.*"}},
      {"score",
       {"glint/scene/image_files.h",
        "metrics/metric.h",
        "metrics/view/*.cpp",
        "metrics/mesh/*.cpp",
        "metrics/tools/mesh_inputs.h",
        "reports/run/bench/evaluate.cpp",
        "reports/run/bench/mesh_eval*.cpp",
        "reports/run/bench/stages.cpp"}}};
  return all;
}

}  // namespace glint
