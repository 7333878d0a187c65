// SPDX-License-Identifier: MIT
#include "datasets/transforms_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "glint/core/error.h"
#include "glint/core/json_error.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

// A frame's fields, with those of the whole file behind them. Every error names file and frame.
struct FrameReader {
  const Json& file;
  const Json& frame;
  std::string where;

  const Json* find(const char* key) const {
    if (const auto it = frame.find(key); it != frame.end()) return &*it;
    if (const auto it = file.find(key); it != file.end()) return &*it;
    return nullptr;
  }

  double number(const char* key, double otherwise) const {
    const Json* value = find(key);
    if (value == nullptr) return otherwise;
    GLINT_CHECK(
        value->is_number(),
        kBadReference,
        "{}: {} is {}, expected a number",
        where,
        key,
        value->dump()
    );
    return value->get<double>();
  }

  std::string path(const char* key) const { return with_slashes(text(key)); }

  std::string text(const char* key) const {
    const Json* value = find(key);
    GLINT_CHECK(
        value != nullptr && value->is_string(), kBadReference, "{}: {}: expected a text", where, key
    );
    return value->get<std::string>();
  }
};

// Pixels; 0 when not stated.
int read_extent(const FrameReader& reader, const char* key) {
  const double extent = reader.number(key, 0);
  GLINT_CHECK(
      extent >= 0 && extent < 1e6,
      kBadReference,
      "{}: {} is {}, expected a number of pixels",
      reader.where,
      key,
      extent
  );
  return static_cast<int>(extent);
}

double focal_from_angle(const FrameReader& reader, const char* angle, int extent) {
  const double radians = reader.number(angle, 0);
  return radians > 0 && extent > 0 ? 0.5 * extent / std::tan(0.5 * radians) : 0;
}

// Pixels; 0: stated by neither key. One that is stated is above 0.
double read_focal(const FrameReader& reader, const char* key, const char* angle, int extent) {
  if (reader.find(key) == nullptr) return focal_from_angle(reader, angle, extent);
  const double focal = reader.number(key, 0);
  GLINT_CHECK(
      focal > 0, kBadReference, "{}: {} is {}, expected pixels above 0", reader.where, key, focal
  );
  return focal;
}

// `image` gives the size when the file does not.
void read_intrinsics(const FrameReader& reader, const fs::path& image, Camera& camera) {
  camera.width = read_extent(reader, "w");
  camera.height = read_extent(reader, "h");
  if (camera.width == 0 || camera.height == 0) {
    const ImageSize size = read_image_size(image);
    camera.width = size.width;
    camera.height = size.height;
  }
  camera.fx = read_focal(reader, "fl_x", "camera_angle_x", camera.width);
  camera.fy = read_focal(reader, "fl_y", "camera_angle_y", camera.height);
  if (camera.fy == 0) camera.fy = camera.fx;
  if (camera.fx == 0) camera.fx = camera.fy;
  GLINT_CHECK(
      camera.fx != 0,
      kBadReference,
      "{}: no focal length; expected fl_x or camera_angle_x",
      reader.where
  );
  camera.cx = reader.number("cx", 0.5 * camera.width);
  camera.cy = reader.number("cy", 0.5 * camera.height);
}

// distortion_params, k1 k2 k3 k4 p1 p2, in OpenCV's order; empty: there is none.
std::vector<double> distortion_list(const FrameReader& reader) {
  const Json* list = reader.find("distortion_params");
  if (list == nullptr) return {};
  const bool good =
      list->is_array() && list->size() == 6 &&
      std::all_of(list->begin(), list->end(), [](const Json& v) { return v.is_number(); });
  GLINT_CHECK(
      good && (*list)[3] == 0,
      kBadReference,
      "{}: distortion_params is {}, expected the numbers k1 k2 k3 k4 p1 p2 with k4 = 0: undistort "
      "the images first",
      reader.where,
      list->dump()
  );
  std::vector<double> distortion;
  for (const std::size_t i : {0u, 1u, 4u, 5u, 2u}) distortion.push_back((*list)[i].get<double>());
  return distortion;
}

// instant-ngp's words for other lenses than OpenCV's.
void refuse_other_lenses(const FrameReader& reader) {
  for (const char* key : {"is_fisheye", "is_latlong", "ftheta_p0", "ftheta_p1"}) {
    const Json* value = reader.find(key);
    GLINT_CHECK(
        value == nullptr || *value == false || *value == 0,
        kBadReference,
        "{}: {} is {}; expected OPENCV or PINHOLE: undistort the images first",
        reader.where,
        key,
        value == nullptr ? "" : value->dump()
    );
  }
}

std::vector<double> read_distortion(const FrameReader& reader) {
  refuse_other_lenses(reader);
  const Json* model = reader.find("camera_model");
  const std::string name = model == nullptr ? "OPENCV" : reader.text("camera_model");
  const std::set<std::string> known{
      "OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL"};
  GLINT_CHECK(
      known.contains(name) && reader.number("k4", 0) == 0,
      kBadReference,
      "{}: camera_model {}{}; expected OPENCV or PINHOLE: undistort the images first",
      reader.where,
      name,
      known.contains(name) ? " with k4" : ""
  );
  std::vector<double> distortion = distortion_list(reader);
  if (distortion.empty())
    for (const char* key : {"k1", "k2", "p1", "p2", "k3"})
      distortion.push_back(reader.number(key, 0));
  const bool none =
      std::all_of(distortion.begin(), distortion.end(), [](double d) { return d == 0; });
  return none ? std::vector<double>{} : distortion;
}

using Row = std::array<double, 4>;

Row read_row(const Json& row, const std::string& expected) {
  GLINT_CHECK(row.is_array() && row.size() == 4, kBadReference, "{}", expected);
  Row values{};
  for (std::size_t j = 0; j < 4; ++j) {
    GLINT_CHECK(row[j].is_number(), kBadReference, "{}, found {}", expected, row[j].dump());
    values[j] = row[j].get<double>();
  }
  return values;
}

// transform_matrix: 3 or 4 rows of 4 numbers, camera to world.
std::array<Row, 3> read_matrix(const FrameReader& reader) {
  const Json* matrix = reader.find("transform_matrix");
  const std::string expected =
      fmt::format("{}: transform_matrix: expected 4 x 4 numbers", reader.where);
  const std::size_t height = matrix != nullptr && matrix->is_array() ? matrix->size() : 0;
  GLINT_CHECK(height == 3 || height == 4, kBadReference, "{}", expected);
  std::array<Row, 3> values{};
  for (std::size_t i = 0; i < 3; ++i) values[i] = read_row((*matrix)[i], expected);
  GLINT_CHECK(
      height == 3 || read_row((*matrix)[3], expected) == Row({0, 0, 0, 1}),
      kBadReference,
      "{}: transform_matrix: its last row is {}, expected 0 0 0 1: the camera's position belongs "
      "into the last column (is it transposed?)",
      reader.where,
      (*matrix)[3].dump()
  );
  return values;
}

// The columns of the matrix are the camera's right, up and backward axes and its centre, in the
// world; the rows of R are right, down and forward.
void read_pose(const FrameReader& reader, Camera& camera) {
  const auto m = read_matrix(reader);
  const auto column = [&](std::size_t j) { return Vec3d{m[0][j], m[1][j], m[2][j]}; };
  camera.rotation_cam_from_world = {{column(0), -column(1), -column(2)}};
  camera.translation_cam_from_world = -(camera.rotation_cam_from_world * column(3));
}

// file_path may lack its extension (Blender exports), and name pictures of which only smaller
// copies are there (DL3DV).
fs::path find_image(const fs::path& folder, const std::string& file_path) {
  const fs::path path = (folder / file_path).lexically_normal();
  std::vector<std::string> endings{""};
  endings.insert(endings.end(), kPictureExtensions.begin(), kPictureExtensions.end());
  endings.insert(endings.end(), {".JPG", ".PNG"});
  for (const std::string& ending : endings)
    if (const fs::path found = picture_or_copy(path.string() + ending); is_file(found))
      return found;
  return picture_called_alike(path);
}

ViewSource make_view(const FrameReader& reader, const fs::path& folder) {
  ViewSource view;
  const std::string file_path = reader.path("file_path");
  view.name = fs::path(file_path).lexically_normal().string();
  view.image = find_image(folder, file_path);
  view.where = fmt::format("{} ({})", reader.where, file_path);
  view.scales_with_image = true;
  read_intrinsics(reader, view.image, view.camera);
  read_pose(reader, view.camera);
  view.distortion = read_distortion(reader);
  if (reader.frame.contains("mask_path"))
    view.counted = picture_or_copy((folder / reader.path("mask_path")).lexically_normal());
  return view;
}

}  // namespace

Json parse_transforms(const fs::path& path) {
  try {
    const std::string text = read_text(path);
    check_json_text(text, path);
    Json json = Json::parse(text);
    GLINT_CHECK(
        json.is_object() && json.contains("frames") && json["frames"].is_array(),
        kBadReference,
        "{}: frames: expected a list",
        path.string()
    );
    constexpr std::size_t kMostFrames = 100000;
    GLINT_CHECK(
        json["frames"].size() <= kMostFrames,
        kBadReference,
        "{}: {} frames, expected at most {}; it is damaged, or not what it is taken for",
        path.string(),
        json["frames"].size(),
        kMostFrames
    );
    return json;
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        ExitCode::kBadReference,
        fmt::format("{}: {}; it is cut off or damaged", path.string(), json_error(error))
    );
  }
}

void read_frames(const Json& json, const fs::path& file, SceneIndex& index) {
  std::size_t i = 0;
  for (const Json& frame : json["frames"]) {
    const std::string where = fmt::format("{}: frame {}", file.string(), i++);
    try {
      GLINT_CHECK(frame.is_object(), kBadReference, "{}: expected an object", where);
      index.views.push_back(make_view({json, frame, where}, file.parent_path()));
    } catch (const Error& error) {
      index.problems.push_back(make_finding("camera-field", where, error.what()));
    }
  }
}

}  // namespace glint
