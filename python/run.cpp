// SPDX-License-Identifier: MIT
#include "python/run.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "glint/core/presence.h"
#include "python/arrays.h"
#include "python/calls.h"
#include "python/json.h"
#include "reports/run/bench/stages.h"
#include "reports/run/records/parcel_run.h"
#include "reports/verbs/single_cell.h"

namespace glint::python {

namespace py = pybind11;

void Run::keep(std::unique_ptr<Method> ended) {
  const std::lock_guard lock(mutex);
  kept_ = std::move(ended);
  method = kept_.get();
}

Method& Run::checked() const {
  GLINT_CHECK(
      method != nullptr,
      kUsage,
      "{}: its training has not begun, or ended by an exception; train again",
      folder.empty() ? method_id : folder
  );
  return *method;
}

namespace {

py::dict rendered(Run& run, const std::function<MapSet(Method&)>& render) {
  return arrays_of(without_gil([&] { return run.with_method(render); }));
}

template <class F>
auto of_method(Run& run, F&& f) {
  return without_gil([&] { return run.with_method(f); });
}

// A cell that was opened, as a run; its lock is free again.
RunPointer run_of(SingleCell single) {
  auto scene = std::make_shared<const Scene>(std::move(single.scene));
  const RunSpec& spec = single.spec;
  auto run = std::make_shared<Run>(spec.method, spec.folder.string(), spec.options, scene);
  run->keep(load_trained(spec));
  return run;
}

RunPointer open_run(const std::string& folder, const std::string& dataset) {
  return without_gil([&] {
    choose_device_once();
    refuse_parcel_run(folder, "render");
    return run_of(open_single_cell(folder, dataset));
  });
}

// The model becomes a run in a folder that goes again.
RunPointer open_model(
    const std::string& model, const std::string& dataset, double max_pixels, double image_ratio
) {
  return without_gil([&] {
    choose_device_once();
    const TemporaryFolder folder("glint_model");
    CommonOptions common;
    common.out = common.data = folder.path().string();
    NewCellOptions options;
    options.dataset = dataset;
    options.model = model;
    options.method = "model";
    options.max_pixels = max_pixels;
    options.image_ratio = image_ratio;
    SingleCell single = new_single_cell(common, options);
    auto scene = std::make_shared<const Scene>(std::move(single.scene));
    auto run = std::make_shared<Run>(single.spec.method, "", single.spec.options, scene);
    run->keep(load_trained(single.spec));
    return run;
  });
}

constexpr const char* kRunHelp =
    R"(A trained method (load_run(), load_model(), train()), or one in training, as callbacks get it.

Several threads may ask; one renders at a time.)";

constexpr const char* kRenderHelp =
    R"(Maps of a Camera or a View, {id: float32 [H][W][C]}.

"rgb" [H][W][3] as displayed, not clamped; "depth" [H][W][1] planar z in metres, 0 where nothing is;
"normal" [H][W][3] unit, camera space; of methods with glass "transparency", "specularity" and
"behind_depth" [H][W][1], "interface", "transmission", "reflection", "transmitted", "reflected" [H][W][3].
A View, not its Camera, is for methods that were published with a mask of glass as input at test views.)";

using RunClass = py::class_<Run, RunPointer>;

void add_rendering(RunClass& run) {
  run.def(
         "render",
         [](Run& self, const Camera& camera) {
           return rendered(self, [&](Method& method) { return method.render(camera); });
         },
         py::arg("camera"),
         kRenderHelp
  )
      .def(
          "render",
          [](Run& self, const ViewOfScene& view) {
            return rendered(self, [&](Method& method) { return method.render_view(*view.view); });
          },
          py::arg("view")
      );
}

// What it is.
void add_identity(RunClass& run) {
  run.def_property_readonly(
         "method", [](const Run& self) { return self.method_id; }, "str: id, \"glint\""
  )
      .def_property_readonly(
          "folder",
          [](const Run& self) -> py::object {
            if (self.folder.empty()) return py::none();
            return text_to_python(self.folder);
          },
          "str: the run's folder; None: it is in memory alone"
      )
      .def_property_readonly(
          "iterations", [](const Run& self) { return self.options.iterations; }, "int"
      )
      .def_property_readonly(
          "seed", [](const Run& self) { return self.options.seed; }, "int"
      )
      .def_property_readonly(
          "scene", [](const Run& self) { return SceneHandle{self.scene}; }, "Scene"
      )
      .def("__repr__", [](const Run& self) {
        return fmt::format(
            "Run({} on {}{})",
            self.method_id,
            self.scene->name,
            self.folder.empty() ? "" : ", " + self.folder
        );
      });
}

// What its method says of itself.
void add_state(RunClass& run) {
  run.def_property_readonly(
         "config",
         [](Run& self) {
           return to_python(of_method(self, [](Method& method) { return method.config(); }));
         },
         "dict: every setting of the method (`glint-bench methods ID`)"
  )
      .def_property_readonly(
          "num_surfels",
          [](Run& self) {
            return of_method(self, [](Method& method) { return method.num_surfels(); });
          },
          "int"
      )
      .def_property_readonly(
          "warnings",
          [](Run& self) {
            return texts_to_python(of_method(self, [](Method& method) { return method.warnings(); })
            );
          },
          "list of str: losses that are off, priors that are missing"
      )
      .def_property_readonly(
          "notes",
          [](Run& self) {
            return texts_to_python(of_method(self, [](Method& method) { return method.notes(); }));
          },
          "list of str: what readers of tables have to know: which masks it was given"
      );
}

}  // namespace

void add_run(py::module_& module) {
  RunClass run(module, "Run", kRunHelp);
  add_rendering(run);
  add_identity(run);
  add_state(run);
  module.def("load_run", &open_run, py::arg("folder"), py::arg("dataset"));
  module.def(
      "load_model",
      &open_model,
      py::arg("model"),
      py::arg("dataset"),
      py::arg("max_pixels"),
      py::arg("image_ratio")
  );
}

}  // namespace glint::python
