// SPDX-License-Identifier: MIT
#include "datasets/released_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

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

bool is_file(const fs::path& path) {
  std::error_code code;
  return fs::is_regular_file(path, code);
}

}  // namespace

fs::path released_truth(const fs::path& scene) {
  const fs::path here = fs::absolute(scene / ".").lexically_normal().parent_path();
  const fs::path name = here.filename();
  for (const fs::path& folder :
       {here / "geometry_gt" / name,
        here / "geometry_gt",
        here.parent_path() / "geometry_gt" / name})
    if (is_folder(folder / "depths_gt") || is_file(folder / "gt_mesh.ply")) return folder;
  return {};
}

void add_released_maps(const fs::path& truth, const std::string& view, MapFiles& files) {
  const std::string number = number_in(view);
  if (truth.empty() || number.empty()) return;
  const auto add = [&](MapId map, const char* folder, const char* kind) {
    const fs::path file = truth / folder / fmt::format("val_{}_{}.npy", kind, number);
    if (!files.has(map) && is_file(file)) files[map] = file;
  };
  add("depth", "depths_gt", "depthZ");
  add("normal", "normals_gt", "normalCam");
}

fs::path true_mesh(const fs::path& scene, const std::string& mesh) {
  const fs::path released = mesh == kTrueMesh ? released_truth(scene) / "gt_mesh.ply" : "";
  return !is_file(scene / mesh) && is_file(released) ? released : scene / mesh;
}

}  // namespace glint
