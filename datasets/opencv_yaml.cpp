// SPDX-License-Identifier: MIT
#include "datasets/opencv_yaml.h"

#include <algorithm>
#include <cmath>

#include "datasets/camera_yaml.h"
#include "glint/core/error.h"

namespace glint {
namespace {

using nlohmann::json;

constexpr double kMaxSide = 1 << 20;  // pixels; more is no image size

class YamlFile {
 public:
  explicit YamlFile(const fs::path& path) : path_(path.string()) {
    const std::string text = read_text(path);
    GLINT_CHECK(!text.empty(), kBadReference, "{}: the file is empty", path_);
    root_ = parse_camera_yaml(text, path_);
    GLINT_CHECK(
        root_.is_object(),
        kBadReference,
        "{}: holds no fields; expected 'names' and a matrix per camera",
        path_
    );
  }

  const std::string& path() const { return path_; }
  // Null where there is none.
  const json& operator[](const std::string& key) const {
    static const json none;
    const auto found = root_.find(key);
    return found == root_.end() ? none : *found;
  }

 private:
  std::string path_;
  json root_;
};

// The camera under construction and the place where its problems go.
struct CameraReader {
  const YamlFile& file;
  OpencvCamera& camera;

  void complain(const std::string& key, const std::string& message) const {
    camera.problems.push_back(fmt::format("{}: {}: {}", file.path(), key, message));
  }

  // The values of matrix PREFIX_NAME, row by row; empty when absent or (with a problem noted) when
  // malformed.
  std::vector<double> matrix(const std::string& prefix) const {
    const std::string key = prefix + camera.name;
    const json& node = file[key];
    if (node.is_null()) return {};
    const json data = node.is_object() ? node.value("data", json()) : node;
    const bool good = data.is_array() && std::all_of(data.begin(), data.end(), [](const json& v) {
                        return v.is_number();
                      });
    if (!good) {
      complain(key, "not a matrix of numbers");
      return {};
    }
    return data.get<std::vector<double>>();
  }

  // As matrix(), with `count` values; notes a problem when absent.
  std::vector<double> require(const std::string& prefix, std::size_t count) const {
    std::vector<double> values = matrix(prefix);
    if (values.size() == count) return values;
    complain(prefix + camera.name, fmt::format("{} values, expected {}", values.size(), count));
    return {};
  }

  int extent(const std::string& prefix) const {
    const json& node = file[prefix + camera.name];
    if (node.is_null()) return 0;
    const double value = node.is_number() ? node.get<double>() : kMaxSide + 1.0;
    if (value == 0 || value == -1) return 0;  // EasyVolcap's words for not known
    if (value >= 1 && value <= kMaxSide) return static_cast<int>(value);
    complain(prefix + camera.name, "not a number of pixels");
    return 0;
  }
};

Mat3d to_matrix(const std::vector<double>& m) {
  return {{{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}}};
}

// Rodrigues: axis times angle, to a rotation by way of the half-angle quaternion.
Mat3d rotation_from_vector(Vec3d v) {
  const double angle = length(v);
  if (!(angle > 1e-12)) return rotation_from_quaternion({1, 0.5 * v.x, 0.5 * v.y, 0.5 * v.z});
  const double s = std::sin(0.5 * angle) / angle;
  return rotation_from_quaternion({std::cos(0.5 * angle), s * v.x, s * v.y, s * v.z});
}

void read_intrinsics(const CameraReader& reader) {
  Camera& camera = reader.camera.camera;
  const std::vector<double> k = reader.require("K_", 9);
  if (!k.empty()) {
    camera.fx = k[0], camera.cx = k[2];
    camera.fy = k[4], camera.cy = k[5];
    if (std::abs(k[1]) > 1e-6 * std::abs(k[0]))
      reader.complain("K_" + reader.camera.name, "has skew; expected K_[0][1] = 0");
  }
  camera.width = reader.extent("W_");
  camera.height = reader.extent("H_");
  std::vector<double> distortion = reader.matrix("D_");
  if (distortion.empty()) distortion = reader.matrix("dist_");
  const bool none =
      std::all_of(distortion.begin(), distortion.end(), [](double d) { return d == 0; });
  if (none) return;
  if (distortion.size() != 4 && distortion.size() != 5)
    reader.complain(
        "D_" + reader.camera.name, fmt::format("{} values, expected 4 or 5", distortion.size())
    );
  else
    reader.camera.distortion = distortion;
}

// EasyVolcap takes R where a file has R and Rot.
void compare_rotations(const CameraReader& reader, const std::vector<double>& matrix) {
  constexpr double kSame = 1e-3;
  const std::vector<double> vector = reader.matrix("R_");
  if (vector.size() != 3 || matrix.empty()) return;
  const Mat3d a = rotation_from_vector({vector[0], vector[1], vector[2]}), b = to_matrix(matrix);
  for (int i = 0; i < 3; ++i)
    if (!(length(a.rows[i] - b.rows[i]) < kSame))
      return reader.complain("Rot_" + reader.camera.name, "is another rotation than R_");
}

void read_pose(const CameraReader& reader) {
  Camera& camera = reader.camera.camera;
  if (!reader.file["Rot_" + reader.camera.name].is_null()) {
    const std::vector<double> rotation = reader.require("Rot_", 9);
    if (!rotation.empty()) camera.rotation_cam_from_world = to_matrix(rotation);
    compare_rotations(reader, rotation);
  } else {
    const std::vector<double> rotation = reader.require("R_", 3);
    if (!rotation.empty())
      camera.rotation_cam_from_world =
          rotation_from_vector({rotation[0], rotation[1], rotation[2]});
  }
  const std::vector<double> t = reader.require("T_", 3);
  if (!t.empty()) camera.translation_cam_from_world = {t[0], t[1], t[2]};
}

std::vector<std::string> read_names(const YamlFile& file) {
  const json& node = file["names"];
  std::vector<std::string> names;
  for (const json& name : node.is_array() ? node : json::array()) {
    GLINT_CHECK(
        name.is_string(),
        kBadReference,
        "{}: names: entry {} is not a text; put quotes around every name",
        file.path(),
        names.size()
    );
    names.push_back(name.get<std::string>());
  }
  GLINT_CHECK(
      !names.empty(), kBadReference, "{}: names: expected a list of camera names", file.path()
  );
  return names;
}

// Both files list the same cameras; a shorter list is a file that was cut off.
void check_same_names(const YamlFile& intrinsics, const YamlFile& extrinsics) {
  if (intrinsics["names"].is_null()) return;
  std::vector<std::string> a = read_names(intrinsics), b = read_names(extrinsics);
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  GLINT_CHECK(
      a == b,
      kBadReference,
      "{}: names: {} names, not the {} of {}; list the same cameras in both files",
      extrinsics.path(),
      b.size(),
      a.size(),
      intrinsics.path()
  );
}

}  // namespace

std::vector<OpencvCamera> read_opencv_cameras(const fs::path& intri, const fs::path& extri) {
  const YamlFile intrinsics(intri), extrinsics(extri);
  check_same_names(intrinsics, extrinsics);
  std::vector<OpencvCamera> cameras;
  for (const std::string& name : read_names(extrinsics)) {
    OpencvCamera camera;
    camera.name = name;
    read_intrinsics({intrinsics, camera});
    read_pose({extrinsics, camera});
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace glint
