// SPDX-License-Identifier: MIT
#include "glint/scene/camera_path_file.h"

#include <cmath>
#include <numbers>

#include "glint/core/config.h"
#include "glint/scene/camera_path.h"

namespace glint {

namespace {

constexpr int kSchema = 1;
constexpr std::size_t kMaxFrames = 1000000;
constexpr double kMaxPixels = 16384;  // a side
constexpr double kRigid = 1e-3;       // how far R R^T may be from the identity
enum class Axes { kOpenCv, kOpenGl };

using Matrix = std::array<std::array<double, 4>, 3>;

// 3 or 4 rows of 4 numbers, or the 16 of a flat list.
Matrix read_matrix(const Json& json, const std::string& where) {
  Json flat = Json::array();
  for (const Json& row : json) {
    if (row.is_array())
      flat.insert(flat.end(), row.begin(), row.end());
    else
      flat.push_back(row);
  }
  const bool fits = flat.size() == 12 || flat.size() == 16;
  GLINT_CHECK(fits, kBadPrediction, "{}: expected 4 x 4 numbers, found {}", where, json.dump());
  Matrix matrix{};
  for (std::size_t i = 0; i < 12; ++i) {
    GLINT_CHECK(flat[i].is_number(), kBadPrediction, "{}: {} is no number", where, flat[i].dump());
    matrix[i / 4][i % 4] = flat[i].get<double>();
  }
  return matrix;
}

// The columns are the camera's axes and its centre in the world; the rows of R are right, down and
// forward.
void set_pose(Camera& camera, const Matrix& m, Axes axes, const std::string& where) {
  const auto column = [&](std::size_t j) { return Vec3d{m[0][j], m[1][j], m[2][j]}; };
  const double sign = axes == Axes::kOpenGl ? -1 : 1;
  const Mat3d rotation{{column(0), sign * column(1), sign * column(2)}};
  const Mat3d product = rotation * transpose(rotation);
  double off = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      off = std::max(off, std::abs(product.rows[i][j] - (i == j ? 1.0 : 0.0)));
  const bool finite = std::isfinite(length2(column(3)));
  GLINT_CHECK(
      off < kRigid && determinant(rotation) > 0 && finite,
      kBadPrediction,
      "{}: no rigid pose (its axes are {:.3g} off unit length and right angles); expected the "
      "rotation and centre of a camera, without scale or mirror",
      where,
      off
  );
  camera.rotation_cam_from_world = rotation;
  camera.translation_cam_from_world = -(rotation * column(3));
}

// A positive number of the first that has it; 0: neither.
double number(const Json& frame, const Json& file, const char* key, const std::string& where) {
  for (const Json* json : {&frame, &file})
    if (const auto it = json->find(key); it != json->end()) {
      GLINT_CHECK(
          it->is_number() && it->get<double>() > 0 && it->get<double>() < 1e7,
          kBadPrediction,
          "{}: {} is {}, expected a number above 0",
          where,
          key,
          it->dump()
      );
      return it->get<double>();
    }
  return 0;
}

// Pixels, of any sign: a cropped picture's principal point may lie beside it.
double coordinate(
    const Json& frame, const Json& file, const char* key, double otherwise, const std::string& where
) {
  for (const Json* json : {&frame, &file})
    if (const auto it = json->find(key); it != json->end()) {
      GLINT_CHECK(
          it->is_number() && std::abs(it->get<double>()) < 1e7,
          kBadPrediction,
          "{}: {} is {}, expected a number of pixels",
          where,
          key,
          it->dump()
      );
      return it->get<double>();
    }
  return otherwise;
}

struct LensKeys {
  const char *width, *height, *fx, *fy, *cx, *cy;
};
constexpr LensKeys kOwnKeys{"width", "height", "fx", "fy", "cx", "cy"};
constexpr LensKeys kTransformsKeys{"w", "h", "fl_x", "fl_y", "cx", "cy"};

ImageSize read_size(double width, double height, const std::string& where) {
  GLINT_CHECK(
      width >= 1 && height >= 1 && width <= kMaxPixels && height <= kMaxPixels,
      kBadPrediction,
      "{}: {} x {} pixels; expected 1 to {} a side",
      where,
      width,
      height,
      kMaxPixels
  );
  return {static_cast<int>(width), static_cast<int>(height)};
}

Camera read_lens(
    const Json& frame,
    const Json& file,
    const LensKeys& keys,
    const Camera& lens,
    const std::string& where
) {
  const auto of = [&](const char* key) { return number(frame, file, key, where); };
  const double width = of(keys.width), fx = of(keys.fx), angle = of("camera_angle_x");
  if (width == 0) return lens;
  Camera camera;
  const ImageSize size = read_size(width, of(keys.height), where);
  camera.width = size.width, camera.height = size.height;
  camera.fx = fx > 0 ? fx : angle > 0 ? 0.5 * size.width / std::tan(0.5 * angle) : 0;
  GLINT_CHECK(camera.fx > 0, kBadPrediction, "{}: a size, but no focal length {}", where, keys.fx);
  const double fy = of(keys.fy);
  camera.fy = fy > 0 ? fy : camera.fx;
  camera.cx = coordinate(frame, file, keys.cx, 0.5 * size.width, where);
  camera.cy = coordinate(frame, file, keys.cy, 0.5 * size.height, where);
  return camera;
}

// nerfstudio's viewer: a vertical field of view in degrees.
Camera read_viewer_lens(
    const Json& frame, const Json& file, const Camera& lens, const std::string& where
) {
  const double width = number({}, file, "render_width", where),
               height = number({}, file, "render_height", where),
               fov = number(frame, file, "fov", where);
  if (width == 0 || fov == 0) return lens;
  const ImageSize size = read_size(width, height, where);
  Camera camera;
  camera.width = size.width, camera.height = size.height;
  camera.fx = camera.fy = 0.5 * size.height / std::tan(fov * std::numbers::pi / 360);
  camera.cx = 0.5 * size.width, camera.cy = 0.5 * size.height;
  return camera;
}

Camera read_frame(
    const Json& frame, const Json& file, const Camera& lens, const std::string& where
) {
  GLINT_CHECK(frame.is_object(), kBadPrediction, "{}: expected an object", where);
  const struct {
    const char* key;
    Axes axes;
  } kinds[] = {
      {"world_from_cam", Axes::kOpenCv},
      {"transform_matrix", Axes::kOpenGl},
      {"camera_to_world", Axes::kOpenGl}};
  for (const auto& [key, axes] : kinds) {
    if (!frame.contains(key)) continue;
    const bool own = axes == Axes::kOpenCv, viewer = std::string_view(key) == "camera_to_world";
    Camera camera = viewer ? read_viewer_lens(frame, file, lens, where)
                           : read_lens(frame, file, own ? kOwnKeys : kTransformsKeys, lens, where);
    set_pose(camera, read_matrix(frame[key], where + ": " + key), axes, where);
    return camera;
  }
  throw Error(
      ExitCode::kBadPrediction,
      where +
          ": no pose; expected world_from_cam (OpenCV axes), transform_matrix or "
          "camera_to_world (OpenGL axes)"
  );
}

Json lens_json(const Camera& lens) {
  return {
      {"width", lens.width},
      {"height", lens.height},
      {"fx", lens.fx},
      {"fy", lens.fy},
      {"cx", lens.cx},
      {"cy", lens.cy}};
}

Json matrix_json(const Camera& camera) {
  const Vec3d center = camera.center();
  const Mat3d axes = transpose(camera.rotation_cam_from_world);
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i)
    rows.push_back({axes.rows[i].x, axes.rows[i].y, axes.rows[i].z, center[i]});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

}  // namespace

Json camera_to_json(const Camera& camera) {
  Json json = lens_json(camera);
  json["world_from_cam"] = matrix_json(camera);
  return json;
}

Camera camera_from_json(const Json& json, const Camera& lens, const std::string& where) {
  return read_frame(json, Json::object(), lens, where);
}

void write_camera_path(const fs::path& file, const CameraPath& path) {
  Json json = {{"schema", kSchema}, {"axes", "OpenCV: x right, y down, z forward"}};
  if (path.fps > 0) json["fps"] = path.fps;
  if (!path.cameras.empty()) json.update(lens_json(path.cameras.front()));
  json["frames"] = Json::array();
  for (const Camera& camera : path.cameras)
    json["frames"].push_back({{"world_from_cam", matrix_json(camera)}});
  write_file(file, json.dump(1) + "\n");
}

CameraPath read_camera_path(const fs::path& file, const Camera& lens) {
  const Json json = read_json_object(file, ExitCode::kBadPrediction);
  const std::string where = file.string();
  const char* list = json.contains("camera_path") ? "camera_path" : "frames";
  GLINT_CHECK(
      json.contains(list) && json[list].is_array() && !json[list].empty() &&
          json[list].size() <= kMaxFrames,
      kBadPrediction,
      "{}: no list of frames; expected \"frames\" (our own, transforms.json) or \"camera_path\" "
      "(nerfstudio's viewer)",
      where
  );
  CameraPath path;
  path.fps = number({}, json, "fps", where);
  for (std::size_t i = 0; i < json[list].size(); ++i)
    path.cameras.push_back(
        read_frame(json[list][i], json, lens, fmt::format("{}: {}[{}]", where, list, i))
    );
  return path;
}

}  // namespace glint
