// SPDX-License-Identifier: MIT
#include "datasets/released_truth.h"
#include "glint/core/presence.h"
#include "glint/scene/mesh_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <vector>

namespace glint {
namespace {

// "0012" and "cam_12" -> "0012"; empty: the name ends in no number.
std::string number_in(const std::string& view) {
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  const auto end_of_name = std::find_if_not(view.rbegin(), view.rend(), is_digit).base();
  const std::string digits(end_of_name, view.end());
  if (digits.empty()) return {};
  const std::size_t zeros = std::min(digits.find_first_not_of('0'), digits.size() - 1);
  return fmt::format("{:0>4}", digits.substr(zeros));
}

// A file of that number; empty: it is not there.
fs::path numbered(
    const fs::path& truth, const char* folder, const char* kind, const std::string& number
) {
  const fs::path file = truth / folder / fmt::format("val_{}_{}.npy", kind, number);
  return !truth.empty() && !number.empty() && is_file(file) ? file : fs::path();
}
fs::path depth_of_number(const fs::path& truth, const std::string& number) {
  return numbered(truth, "depths_gt", "depthZ", number);
}

void add_maps(const fs::path& truth, const std::string& number, MapFiles& files) {
  const auto add = [&](MapId map, fs::path file) {
    if (!files.has(map) && !file.empty()) files[map] = std::move(file);
  };
  add("depth", depth_of_number(truth, number));
  add("normal", numbered(truth, "normals_gt", "normalCam", number));
}

}  // namespace

fs::path released_truth(const fs::path& scene) {
  std::error_code code;
  const fs::path folder = scene / ".";  // of a path that ends in a slash, too
  for (const fs::path& named :
       {fs::absolute(folder, code).lexically_normal(), fs::weakly_canonical(folder, code)}) {
    const fs::path here = named.filename().empty() ? named.parent_path() : named;
    fs::path truth = here.parent_path() / "geometry_gt" / here.filename();
    if (is_folder(truth / "depths_gt") || is_file(truth / "gt_mesh.ply")) return truth;
  }
  return {};
}

void add_released_truth(const fs::path& scene, SceneIndex& index) {
  const fs::path truth = released_truth(scene);
  if (truth.empty()) return;
  std::map<std::string, std::vector<ViewSource*>> views_of_number;
  for (ViewSource& view : index.views) views_of_number[number_in(view.name)].push_back(&view);
  for (const auto& [number, views] : views_of_number) {
    if (views.size() == 1) add_maps(truth, number, views.front()->truth);
    const fs::path depth = depth_of_number(truth, number);
    if (views.size() > 1 && !depth.empty())
      index.remarks.push_back(
          {"number-of-several-views",
           depth.string(),
           fmt::format("{} views have names that end in {}: it is not read", views.size(), number)}
      );
  }
}

fs::path released_depth(const fs::path& truth, const std::string& view) {
  return depth_of_number(truth, number_in(view));
}

fs::path true_mesh(const fs::path& scene, const std::string& mesh) {
  const fs::path released = mesh == kTrueMesh ? released_truth(scene) / "gt_mesh.ply" : "";
  const fs::path own = mesh_or_model(scene / mesh);
  return !is_file(own) && is_file(released) ? released : own;
}

}  // namespace glint
