// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <cmath>

#include "glint/core/error.h"
#include "glint/scene/camera_path.h"
#include "python/scene.h"

namespace glint::python {

namespace py = pybind11;

namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Triple = std::array<double, 3>;

Vec3d vector_of(const Triple& values) { return {values[0], values[1], values[2]}; }

py::array_t<double> array_of(Vec3d v) {
  py::array_t<double> array(3);
  for (int i = 0; i < 3; ++i) array.mutable_at(i) = v[i];
  return array;
}

py::array_t<double> array_of(const Mat3d& matrix) {
  py::array_t<double> array({3, 3});
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) array.mutable_at(i, j) = matrix.rows[i][j];
  return array;
}

// Errors (ValueError): no rotation.
Mat3d rotation_of(const Numbers& array) {
  if (array.ndim() != 2 || array.shape(0) != 3 || array.shape(1) != 3)
    throw py::value_error("rotation_cam_from_world: expected shape [3][3]");
  Mat3d matrix;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrix.rows[i][j] = array.at(i, j);
  constexpr double kTolerance = 1e-3;
  double worst = std::abs(dot(cross(matrix.rows[0], matrix.rows[1]), matrix.rows[2]) - 1);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      worst = std::max(worst, std::abs(dot(matrix.rows[i], matrix.rows[j]) - (i == j ? 1 : 0)));
  if (!(worst <= kTolerance))
    throw py::value_error(fmt::format(
        "rotation_cam_from_world: no rotation (off by {:.3g}); its rows are the camera's axes "
        "right, "
        "down, forward in the world, unit and at right angles",
        worst
    ));
  return matrix;
}

void check_lens(int width, int height, double fx, double fy) {
  if (width < 1 || height < 1 || width > 16384 || height > 16384)
    throw py::value_error(
        fmt::format("camera of {} x {} pixels; expected 1 to 16384", width, height)
    );
  if (!(fx > 0 && fy > 0 && std::isfinite(fx) && std::isfinite(fy)))
    throw py::value_error(fmt::format("fx {}, fy {}; expected pixels above 0", fx, fy));
}

Camera make_camera(
    int width,
    int height,
    double fx,
    double fy,
    std::optional<double> cx,
    std::optional<double> cy,
    const std::optional<Numbers>& rotation,
    const Triple& translation
) {
  check_lens(width, height, fx, fy);
  Camera camera{width, height, fx, fy, cx.value_or(0.5 * width), cy.value_or(0.5 * height)};
  if (rotation) camera.rotation_cam_from_world = rotation_of(*rotation);
  camera.translation_cam_from_world = vector_of(translation);
  return camera;
}

Camera camera_looking_at(
    const Triple& eye,
    const Triple& target,
    const Triple& up,
    int width,
    int height,
    double fov_x_deg
) {
  check_lens(width, height, 1, 1);
  if (!(fov_x_deg > 0 && fov_x_deg < 180))
    throw py::value_error(fmt::format("fov_x_deg {}; expected above 0, below 180", fov_x_deg));
  const Vec3d forward = vector_of(target) - vector_of(eye);
  if (!(length(cross(forward, vector_of(up))) > 1e-9 * length(forward)))
    throw py::value_error("eye, target and up: the camera looks along `up`, or nowhere");
  return look_at(vector_of(eye), vector_of(target), vector_of(up), {width, height}, fov_x_deg);
}

std::string camera_text(const Camera& camera) {
  const Vec3d center = camera.center();
  return fmt::format(
      "Camera({} x {} pixels, fx {:.6g}, fy {:.6g}, at [{:.4g}, {:.4g}, {:.4g}])",
      camera.width,
      camera.height,
      camera.fx,
      camera.fy,
      center.x,
      center.y,
      center.z
  );
}

Numbers project_points(const Camera& camera, const Numbers& points) {
  if (points.ndim() != 2 || points.shape(1) != 3)
    throw py::value_error("points: expected shape [N][3], metres, world");
  py::array_t<double> image({points.shape(0), py::ssize_t{3}});
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    const Vec3d in_cam = camera.to_cam({points.at(i, 0), points.at(i, 1), points.at(i, 2)});
    const Vec2d at = camera.project(in_cam);
    image.mutable_at(i, 0) = at.x;
    image.mutable_at(i, 1) = at.y;
    image.mutable_at(i, 2) = in_cam.z;
  }
  return image;
}

constexpr const char* kCameraHelp = R"(A pinhole camera: x right, y down, z forward (OpenCV).

x_cam = rotation_cam_from_world @ x_world + translation_cam_from_world, in metres; pixel (i, j) has its
centre at (i + 0.5, j + 0.5).

width, height: pixels
fx, fy: focal lengths, pixels
cx, cy: principal point, pixels; the middle where not given
rotation_cam_from_world: [3][3], rows are the camera's axes in the world; the unit matrix where not given
translation_cam_from_world: [3], metres)";

using CameraClass = py::class_<Camera>;

void add_making(CameraClass& camera) {
  camera
      .def(
          py::init(&make_camera),
          py::arg("width"),
          py::arg("height"),
          py::arg("fx"),
          py::arg("fy"),
          py::arg("cx") = py::none(),
          py::arg("cy") = py::none(),
          py::arg("rotation_cam_from_world") = py::none(),
          py::arg("translation_cam_from_world") = Triple{}
      )
      .def_static(
          "look_at",
          &camera_looking_at,
          py::arg("eye"),
          py::arg("target"),
          py::arg("up") = Triple{0, 0, 1},
          py::kw_only(),
          py::arg("width"),
          py::arg("height"),
          py::arg("fov_x_deg") = 60.0,
          "A camera at eye [3] that looks at target [3], metres; up [3] points up in the picture. "
          "fov_x_deg: horizontal field of view, degrees."
      )
      .def(
          "with_size",
          [](const Camera& lens, int width, int height) {
            check_lens(width, height, lens.fx, lens.fy);
            return with_size(lens, {width, height});
          },
          py::arg("width"),
          py::arg("height"),
          "The same at another size in pixels: the horizontal field of view stays, rows above and "
          "below come or go."
      );
}

void add_lens(CameraClass& camera) {
  camera.def_readonly("width", &Camera::width, "pixels")
      .def_readonly("height", &Camera::height, "pixels")
      .def_readonly("fx", &Camera::fx, "pixels")
      .def_readonly("fy", &Camera::fy, "pixels")
      .def_readonly("cx", &Camera::cx, "pixels")
      .def_readonly("cy", &Camera::cy, "pixels");
}

void add_pose(CameraClass& camera) {
  camera
      .def_property_readonly(
          "rotation_cam_from_world",
          [](const Camera& self) { return array_of(self.rotation_cam_from_world); },
          "float64 [3][3]"
      )
      .def_property_readonly(
          "translation_cam_from_world",
          [](const Camera& self) { return array_of(self.translation_cam_from_world); },
          "float64 [3], metres"
      )
      .def_property_readonly(
          "center",
          [](const Camera& self) { return array_of(self.center()); },
          "float64 [3]: where the camera stands, metres, world"
      )
      .def(
          "project",
          &project_points,
          py::arg("points"),
          "float64 [N][3]: x and y in pixels and z in metres of points [N][3], metres, world. What "
          "has no z above 0 is behind the camera."
      );
}

}  // namespace

void add_camera(py::module_& module) {
  CameraClass camera(module, "Camera", kCameraHelp);
  add_making(camera);
  add_lens(camera);
  add_pose(camera);
  camera.def("__repr__", &camera_text);
}

}  // namespace glint::python
