// SPDX-License-Identifier: MIT
#include "glint/scene/image_files_depth.h"

#include <algorithm>
#include <cmath>

#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/middle.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"

namespace glint {
namespace {

// In steps where the file holds integers.
Image read_stored(const fs::path& path) {
  Image depth = read_image(path, 1);
  const auto range = static_cast<float>(integer_range(path));
  if (range > 0)
    for (float& value : depth.values()) value = std::nearbyint(value * range);
  return depth;
}

}  // namespace

Image read_depth(const fs::path& path, const DepthSteps& scale) {
  Image depth = read_stored(path);
  if (!stores_integers(path)) return depth;
  GLINT_CHECK(
      scale.known(),
      kBadReference,
      "{}: integers hold no metres by themselves; give --depth-scale, metres of a step (0.001 for "
      "millimetres, as ScanNet has them; 0.0002 for TUM)",
      path.string()
  );
  for (float& value : depth.values())
    value = static_cast<float>(static_cast<double>(value) * scale.metres);
  return depth;
}

DepthSteps glassrecon_depth_scale(const fs::path& path) {
  const fs::path absolute = fs::absolute(path);
  for (fs::path folder = absolute.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    const std::string name = folder.filename().string();
    if (name != "evaluation_depths" && name != "completed_depths" && name != "sensor_depths")
      continue;
    const fs::path file =
        folder.parent_path() / "intrinsics" / absolute.filename().replace_extension(".json");
    if (!is_file(file)) return {};
    const double scale =
        number_or(read_json_object(file, ExitCode::kBadReference), "depth_scale", 0);
    if (!(scale > 0 && std::isfinite(scale))) return {};
    // Metres of a step, or steps of a metre.
    return {scale > 1 ? 1 / scale : scale, "intrinsics/" + file.filename().string()};
  }
  return {};
}

Image read_glassrecon_depth(const fs::path& path, const DepthSteps& scale) {
  Image depth = read_stored(path);
  for (float& value : depth.values())
    value = static_cast<float>(static_cast<double>(value) * scale.metres);
  return depth;
}

DepthSteps exported_depth_scale(const fs::path& path) {
  fs::path folder = fs::absolute(path).parent_path();
  for (int level = 0; level < 3 && folder.has_relative_path(); ++level) {
    folder = folder.parent_path();
    const fs::path file = folder / "scene.json";
    if (!is_file(file)) continue;
    const Json scene = read_json_object(file, ExitCode::kBadReference);
    const Json side_maps = scene.value("side_maps", Json());
    if (!side_maps.is_boolean() || !side_maps.get<bool>()) return {};
    const double step = number_or(scene, "depth_scale", kMillimetre);
    GLINT_CHECK(
        step > 0 && std::isfinite(step),
        kBadReference,
        "{}: depth_scale is {}; expected metres of a step",
        file.string(),
        step
    );
    return {step, "scene.json"};
  }
  return {};
}

DepthSteps depth_scale_by(const fs::path& path, ImageView reference) {
  constexpr double kNear = 2;
  const Image depth = read_stored(path);
  if (depth.size() != ImageSize{reference.width, reference.height}) return {};
  const double ratio = kMillimetre * median_ratio(depth, reference);
  if (!(ratio > 1 / kNear && ratio < kNear)) return {};
  return {kMillimetre, "the median, near the reference's in millimetres"};
}

}  // namespace glint
