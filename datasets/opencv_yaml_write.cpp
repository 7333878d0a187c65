// SPDX-License-Identifier: MIT
// Written without OpenCV, so that a lean build can write it, too.
#include <cmath>

#include "datasets/opencv_yaml.h"
#include "glint/core/error.h"

namespace glint {
namespace {

constexpr double kNear = 0.05, kFar = 20;  // metres, hints to loaders that ask for them

std::string yaml_matrix(
    const std::string& key, int rows, int cols, const std::vector<double>& data
) {
  std::string values;
  for (const double value : data)
    values += (values.empty() ? "" : ", ") + fmt::format("{:.17g}", value) +
              (value == std::floor(value) && std::abs(value) < 1e15 ? "." : "");
  return fmt::format(
      "{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
      key,
      rows,
      cols,
      values
  );
}

std::string yaml_head(const std::vector<std::string>& names) {
  std::string text = "%YAML:1.0\n---\nnames:\n";
  for (const std::string& name : names) text += fmt::format("   - \"{}\"\n", name);
  return text;
}

std::vector<double> flat(const Mat3d& m) {
  std::vector<double> values;
  for (const Vec3d& row : m.rows) values.insert(values.end(), {row.x, row.y, row.z});
  return values;
}

// Axis times angle.
Vec3d rodrigues(const Mat3d& rotation) {
  Vec4<double> q = quaternion_from_rotation(rotation);
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const Vec3d axis{q.x, q.y, q.z};
  const double sine = length(axis);
  return sine < 1e-12 ? Vec3d{} : (2 * std::atan2(sine, q.w) / sine) * axis;
}

std::string intrinsics_yaml(
    const std::vector<std::string>& names, const std::vector<Camera>& cameras
) {
  std::string text = yaml_head(names);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera& c = cameras[i];
    const std::string& name = names[i];
    text += yaml_matrix("K_" + name, 3, 3, {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1});
    text += fmt::format("H_{}: {}\nW_{}: {}\n", name, c.height, name, c.width);
    text += yaml_matrix("D_" + name, 5, 1, {0, 0, 0, 0, 0});
  }
  return text;
}

std::string extrinsics_yaml(
    const std::vector<std::string>& names, const std::vector<Camera>& cameras
) {
  std::string text = yaml_head(names);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string& name = names[i];
    const Vec3d r = rodrigues(cameras[i].rotation_cam_from_world);
    const Vec3d t = cameras[i].translation_cam_from_world;
    text += yaml_matrix("R_" + name, 3, 1, {r.x, r.y, r.z});
    text += yaml_matrix("Rot_" + name, 3, 3, flat(cameras[i].rotation_cam_from_world));
    text += yaml_matrix("T_" + name, 3, 1, {t.x, t.y, t.z});
    text += fmt::format("n_{}: {}\nf_{}: {:.1f}\n", name, kNear, name, kFar);
  }
  return text;
}

}  // namespace

void write_opencv_cameras(
    const fs::path& folder,
    const std::vector<std::string>& names,
    const std::vector<Camera>& cameras
) {
  write_file(folder / "intri.yml", intrinsics_yaml(names, cameras));
  write_file(folder / "extri.yml", extrinsics_yaml(names, cameras));
}

}  // namespace glint
