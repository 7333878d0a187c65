// SPDX-License-Identifier: MIT
#include "glint/core/error.h"
#include "metrics/fusion/tsdf.h"

namespace glint {

void check_tsdf_options(const TsdfOptions& options) {
  constexpr double kMostTruncation = 100;  // voxels
  const auto check = [](bool good, const char* field, double value, const char* expected) {
    GLINT_CHECK(good, kUsage, "{} is {}; expected {}", field, value, expected);
  };
  check(options.voxel > 0, "voxel", options.voxel, "metres above 0");
  // A point opens the blocks within the truncation distance, and their number goes with its cube.
  check(
      options.truncation_voxels >= 1 && options.truncation_voxels <= kMostTruncation,
      "truncation_voxels",
      options.truncation_voxels,
      "1 to 100"
  );
  check(options.max_memory_mb >= 0, "max_memory_mb", options.max_memory_mb, "MB, or 0");
  check(options.max_depth >= 0, "max_depth", options.max_depth, "metres, or 0");
  check(options.min_cluster >= 0, "min_cluster", options.min_cluster, "a number of triangles");
  for (std::size_t i = 0; i < 3; ++i)
    check(
        options.bounds_min[i] <= options.bounds_max[i],
        "bounds_max",
        options.bounds_max[i],
        "at least bounds_min"
    );
}

}  // namespace glint
