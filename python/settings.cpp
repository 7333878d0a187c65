// SPDX-License-Identifier: MIT
// What holds for the whole process: device, threads, progress.
#include <pybind11/stl.h>

#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "python/calls.h"
#include "python/json.h"
#include "python/run.h"
#include "reports/run/records/environment.h"

namespace glint::python {

namespace py = pybind11;

namespace {

std::once_flag device_chosen;

void set_device(const std::string& name) {
  choose_device(name, false);
  std::call_once(device_chosen, [] {});
}

py::list list_methods() {
  py::list list;
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    py::dict dict;
    dict["id"] = text_to_python(id);
    dict["title"] = text_to_python(spec.title);
    dict["description"] = text_to_python(spec.description);
    list.append(dict);
  }
  return list;
}

}  // namespace

void choose_device_once() {
  std::call_once(device_chosen, [] { choose_device("auto", false); });
}

void add_settings(py::module_& module) {
  module.def(
      "set_device",
      &set_device,
      py::arg("name"),
      "Where methods run: \"auto\" (a GPU where there is one), \"cpu\" or \"cuda\". Before the "
      "first "
      "scene is loaded; without it \"auto\"."
  );
  module.def(
      "set_threads",
      [](int count) {
        if (count < 0) throw py::value_error("count: expected 0 or more");
        set_num_threads(count);
      },
      py::arg("count"),
      "Threads that loops run on; 0: all cores. Results do not depend on it."
  );
  module.def(
      "set_quiet",
      &set_quiet,
      py::arg("quiet"),
      "False: progress and remarks on standard error, as programs have them. Without it True."
  );
  module.def(
      "methods",
      &list_methods,
      "What there is to train, a dict each: \"id\", \"title\", \"description\"."
  );
}

}  // namespace glint::python
