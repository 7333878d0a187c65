// SPDX-License-Identifier: MIT
#include "glint/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/core/error.h"
#include "glint/core/utf8.h"

namespace glint {
namespace {

std::vector<Vec3d> camera_centers(const std::vector<View>& views) {
  std::vector<Vec3d> centers;
  centers.reserve(views.size());
  for (const View& view : views) centers.push_back(view.camera.center());
  return centers;
}

// The value below which `fraction` of the values lie, linear between neighbours.
float percentile(std::vector<float> values, double fraction) {
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::ptrdiff_t>(position);
  std::nth_element(values.begin(), values.begin() + below, values.end());
  const float low = values[static_cast<std::size_t>(below)];
  if (below + 1 == static_cast<std::ptrdiff_t>(values.size())) return low;
  const float high = *std::min_element(values.begin() + below + 1, values.end());
  return low + static_cast<float>(position - static_cast<double>(below)) * (high - low);
}

void bounds_from_points(Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    values.reserve(scene.points.positions.size());
    for (const Vec3f& point : scene.points.positions) values.push_back(point[axis]);
    scene.bounds_min[axis] = percentile(values, 0.005);
    scene.bounds_max[axis] = percentile(values, 0.995);
  }
}

// The box of the cameras and of the points that lie twice the camera extent in front of them.
void bounds_from_cameras(Scene& scene) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  scene.bounds_min = {kInfinity, kInfinity, kInfinity};
  scene.bounds_max = -scene.bounds_min;
  const double reach = 2 * static_cast<double>(scene.spatial_scale);
  for (const View& view : scene.train)
    for (const double depth : {0.0, reach}) {
      const Vec3f point = cast<float>(view.camera.to_world({0, 0, depth}));
      for (int axis = 0; axis < 3; ++axis) {
        scene.bounds_min[axis] = std::min(scene.bounds_min[axis], point[axis]);
        scene.bounds_max[axis] = std::max(scene.bounds_max[axis], point[axis]);
      }
    }
}

}  // namespace

std::string flat_view_name(std::string view_name) {
  std::replace(view_name.begin(), view_name.end(), '/', '_');
  return view_name;
}

std::string why_no_folder_name(std::string_view name) {
  constexpr std::size_t kLongest = 200;  // bytes; file systems allow 255 with what is added
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; };
  if (name.empty()) return "is empty";
  if (name == "." || name == "..") return "names another folder";
  if (std::any_of(name.begin(), name.end(), is_control)) return "holds control characters";
  if (name.find('/') != std::string_view::npos) return "holds a path separator";
  if (!is_utf8(name)) return "is not UTF-8 (the bytes of Latin-1, perhaps)";
  return name.size() > kLongest ? "is longer than 200 bytes" : "";
}

std::string view_name_problem(const std::string& name, std::map<std::string, std::string>& before) {
  const std::string flat = flat_view_name(name);
  if (const std::string why = why_no_folder_name(flat); !why.empty())
    return fmt::format("the view's name '{}' {}; rename the view", as_utf8(name), why);
  const auto [other, is_new] = before.emplace(flat, name);
  if (is_new) return {};
  return other->second == name ? fmt::format("the name {} is used twice; rename one view", name)
                               : fmt::format(
                                     "views {} and {} would share the folder {}; rename one",
                                     other->second,
                                     name,
                                     flat
                                 );
}

float camera_extent(const std::vector<View>& views) {
  const std::vector<Vec3d> centers = camera_centers(views);
  if (centers.empty()) return 0;
  Vec3d mean{};
  for (const Vec3d& center : centers) mean += (1.0 / static_cast<double>(centers.size())) * center;
  double largest = 0;
  for (const Vec3d& center : centers) largest = std::max(largest, length(center - mean));
  return static_cast<float>(1.1 * largest);
}

void set_extent(Scene& scene) {
  const float extent = camera_extent(scene.train);
  scene.spatial_scale = extent > 0 ? extent : 1;
  if (!scene.points.positions.empty())
    bounds_from_points(scene);
  else if (!scene.train.empty())
    bounds_from_cameras(scene);
}

}  // namespace glint
