// SPDX-License-Identifier: MIT
// The program glint-mesh on arrays.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "metrics/tools/mesh_scoring.h"
#include "python/arrays.h"
#include "python/calls.h"
#include "python/json.h"
#include "python/metrics.h"
#include "python/scene.h"

namespace glint::python {

namespace py = pybind11;

namespace {

using FaceArray = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

// Errors: TypeError (no integers), ValueError (shape; a vertex that is not there).
std::vector<Triangle> faces_of(
    const py::object& object, std::size_t num_vertices, const std::string& name
) {
  const py::object kind = py::isinstance<py::array>(object) ? object.attr("dtype").attr("kind")
                                                            : py::object(py::str("?"));
  if (const auto letter = py::cast<std::string>(kind); letter != "i" && letter != "u")
    throw py::type_error(name + ": expected an array of integers, for example int32");
  const auto array = FaceArray::ensure(object);
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw py::value_error(name + ": expected shape [M][3], ids of vertices");
  std::vector<Triangle> faces(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t id = array.at(i, k);
      if (id < 0 || static_cast<std::size_t>(id) >= num_vertices)
        throw py::value_error(fmt::format(
            "{}: face {} has vertex {} of {}; ids count from 0", name, i, id, num_vertices
        ));
      faces[i][k] = static_cast<std::int32_t>(id);
    }
  return faces;
}

// (vertices, faces), or points.
SurfaceInput surface_of(const py::object& object, const std::string& name) {
  if (!py::isinstance<py::tuple>(object) && !py::isinstance<py::list>(object))
    return surface_of_points(name, {rows_of<Vec3f>(object, name), {}});
  const py::sequence pair = object;
  if (pair.size() != 2)
    throw py::value_error(name + ": expected (vertices [N][3], faces [M][3]), or points [N][3]");
  TriangleMesh mesh;
  mesh.vertices = rows_of<Vec3f>(pair[0], name + "[0]");
  mesh.faces = faces_of(pair[1], mesh.vertices.size(), name + "[1]");
  return surface_of_mesh(name, mesh);
}

// `protocol`: the fields of MeshProtocol that are not as usual.
MeshReport report_of(
    SurfaceInput prediction,
    SurfaceInput reference,
    const Json& protocol,
    const std::vector<Camera>& cameras
) {
  MeshReport report;
  config_from_json(report.protocol, protocol, "mesh");
  check_mesh_protocol(report.protocol);
  report.prediction = std::move(prediction);
  report.reference = std::move(reference);
  report.warnings = frame_doubts(report.prediction, report.reference, GltfUp::kY);
  report.protocol.cull = cameras.empty() ? MeshCulling::kNone : MeshCulling::kCameras;
  if (!cameras.empty()) cull_surfaces(report, cameras);
  score_surfaces(report);
  return report;
}

py::object score_mesh(
    const py::object& prediction,
    const py::object& reference,
    const std::vector<Camera>& cameras,
    const std::string& protocol
) {
  SurfaceInput of_reference = surface_of(reference, "truth");
  SurfaceInput of_prediction = with_exit_code(ExitCode::kBadPrediction, [&] {
    return surface_of(prediction, "prediction");
  });
  const MeshReport report = without_gil([&] {
    return report_of(
        std::move(of_prediction), std::move(of_reference), Json::parse(protocol), cameras
    );
  });
  for (const std::string& doubt : report.warnings) warn(doubt);
  Json json = mesh_report_json(report);
  for (const char* name : {"prediction", "reference"}) json.erase(name);
  return to_python(json);
}

}  // namespace

void add_mesh(py::module_& module) { module.def("score_mesh", &score_mesh); }

}  // namespace glint::python
