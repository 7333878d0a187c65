// SPDX-License-Identifier: MIT
#include "python/scene.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "datasets/dataset.h"
#include "python/arrays.h"
#include "python/calls.h"
#include "python/json.h"

namespace glint::python {

namespace py = pybind11;

namespace {

static_assert(sizeof(Vec3f) == 3 * sizeof(float));

// float32 [N][3], not to be written.
py::array rows_array(const std::vector<Vec3f>& rows, py::handle owner) {
  py::array array(
      py::dtype::of<float>(),
      std::vector<py::ssize_t>{static_cast<py::ssize_t>(rows.size()), 3},
      rows.data(),
      owner
  );
  py::setattr(array.attr("flags"), "writeable", py::bool_(false));
  return array;
}

py::array_t<float> array_of_vector(Vec3f v) {
  py::array_t<float> array(3);
  for (int i = 0; i < 3; ++i) array.mutable_at(i) = v[i];
  return array;
}

py::list views_of_scene(const ScenePointer& scene, const std::vector<View>& views) {
  py::list list;
  for (const View& view : views) list.append(ViewOfScene{scene, &view});
  return list;
}

const ViewOfScene& view_in(const py::object& self) { return self.cast<const ViewOfScene&>(); }
const Scene& scene_in(const py::object& self) { return *self.cast<const SceneHandle&>().scene; }

void add_view(py::module_& module) {
  py::class_<ViewOfScene>(
      module,
      "View",
      "A photo of a scene with its camera. Arrays are float32 [H][W][C], not to be written, and "
      "are "
      "the scene's own memory."
  )
      .def_property_readonly(
          "name", [](const ViewOfScene& self) { return text_to_python(self.view->name); }, "str"
      )
      .def_property_readonly(
          "camera", [](const ViewOfScene& self) { return self.view->camera; }, "Camera"
      )
      .def_property_readonly(
          "image",
          [](const py::object& self) { return array_of(view_in(self).view->rgb, self); },
          "[H][W][3] as displayed (sRGB-encoded), in [0, 1]"
      )
      .def_property_readonly(
          "counted",
          [](const py::object& self) -> py::object {
            const Image& counted = view_in(self).view->counted;
            if (counted.empty()) return py::none();
            return array_of(counted, self);
          },
          "[H][W][1], 1: the pixel counts, 0: no loss and no score looks at it; None: all count"
      )
      .def_property_readonly(
          "truth",
          [](const py::object& self) { return arrays_of(view_in(self).view->truth, self); },
          "{id: array} of true maps: \"depth\" [H][W][1] planar z in metres (0: nothing), "
          "\"normal\" "
          "[H][W][3] unit, camera space, \"glass\" [H][W][1] 0 or 1, \"behind_depth\", ... "
          "(docs/reference/formats.md)"
      )
      .def_property_readonly(
          "priors",
          [](const py::object& self) { return arrays_of(view_in(self).view->priors, self); },
          "{id: array} of what networks, or a simulation of them, say: \"depth\" [H][W][1] "
          "relative "
          "(larger: farther), \"normal\" [H][W][3], \"albedo\" [H][W][3], ..."
      )
      .def("__repr__", [](const ViewOfScene& self) {
        const Camera& camera = self.view->camera;
        return fmt::format(
            "View({}, {} x {} pixels)", self.view->name, camera.width, camera.height
        );
      });
}

using SceneClass = py::class_<SceneHandle>;

py::dict points_of(const py::object& self) {
  const PointCloud& points = scene_in(self).points;
  py::dict dict;
  dict["positions"] = rows_array(points.positions, self);
  dict["colors"] = rows_array(points.colors, self);
  if (!points.normals.empty()) dict["normals"] = rows_array(points.normals, self);
  return dict;
}

void add_content(SceneClass& scene) {
  scene
      .def_property_readonly(
          "train",
          [](const SceneHandle& self) { return views_of_scene(self.scene, self.scene->train); },
          "list of training View"
      )
      .def_property_readonly(
          "test",
          [](const SceneHandle& self) { return views_of_scene(self.scene, self.scene->test); },
          "list of test View"
      )
      .def_property_readonly(
          "points",
          &points_of,
          "{\"positions\": [N][3] metres, world; \"colors\": [N][3] in [0, 1]; \"normals\": [N][3] "
          "unit, where there are any}"
      );
}

void add_extent(SceneClass& scene) {
  scene
      .def_property_readonly(
          "bounds_min",
          [](const SceneHandle& self) { return array_of_vector(self.scene->bounds_min); },
          "float32 [3], metres"
      )
      .def_property_readonly(
          "bounds_max",
          [](const SceneHandle& self) { return array_of_vector(self.scene->bounds_max); },
          "float32 [3], metres"
      )
      .def_property_readonly(
          "spatial_scale",
          [](const SceneHandle& self) { return self.scene->spatial_scale; },
          "float, metres: 1.1 x largest distance of training cameras to their mean"
      );
}

void add_identity(SceneClass& scene) {
  scene
      .def_property_readonly(
          "name", [](const SceneHandle& self) { return text_to_python(self.scene->name); }, "str"
      )
      .def_property_readonly(
          "dataset",
          [](const SceneHandle& self) { return text_to_python(self.scene->dataset); },
          "str: \"glassroom\", \"nerfstudio\", ..."
      )
      .def_property_readonly(
          "simulated_priors",
          [](const SceneHandle& self) { return self.scene->simulated_priors; },
          "bool: no network made the priors"
      )
      .def_property_readonly(
          "data_notes",
          [](const SceneHandle& self) { return texts_to_python(self.scene->data_notes); },
          "list of str: how priors were read, how many pixels have one, how pictures were shrunk"
      )
      .def_property_readonly(
          "spec_hash",
          [](const SceneHandle& self) { return text_to_python(self.scene->spec_hash); },
          "str: identifies the data"
      )
      .def(
          "describe",
          [](const SceneHandle& self) { return text_to_python(describe_scene(*self.scene)); },
          "str: views, sizes, priors, truth and points, one line each"
      )
      .def("__repr__", [](const SceneHandle& self) {
        return fmt::format(
            "Scene({}, {}, {} training and {} test views)",
            self.scene->name,
            self.scene->dataset,
            self.scene->train.size(),
            self.scene->test.size()
        );
      });
}

SceneHandle load(
    const std::string& folder,
    double max_pixels,
    double image_ratio,
    const std::string& loader,
    const std::string& background
) {
  LoadOptions options;
  options.max_pixels = max_pixels;
  options.image_ratio = image_ratio;
  options.loader = loader;
  options.background = background;
  return {without_gil([&] { return std::make_shared<const Scene>(load_scene(folder, options)); })};
}

}  // namespace

void add_scene(py::module_& module) {
  add_view(module);
  SceneClass scene(module, "Scene", "What methods train on and are scored by (load_scene()).");
  add_identity(scene);
  add_content(scene);
  add_extent(scene);
  module.def(
      "load_scene",
      &load,
      py::arg("folder"),
      py::arg("max_pixels"),
      py::arg("image_ratio"),
      py::arg("loader"),
      py::arg("background")
  );
}

}  // namespace glint::python
