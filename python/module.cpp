// SPDX-License-Identifier: MIT
// The compiled part of the package glint_bench (python/glint_bench/): what it calls, and its
// classes.
#include <pybind11/pybind11.h>

#include "glint/core/progress.h"
#include "python/calls.h"
#include "python/metrics.h"
#include "python/run.h"
#include "python/scene.h"

PYBIND11_MODULE(_glint_bench, module) {
  using namespace glint::python;
  module.doc() = "The compiled part of glint_bench; import that.";
  glint::set_quiet(true);
  collect_warnings();
  register_errors();
  add_camera(module);
  add_scene(module);
  add_run(module);
  add_training(module);
  add_settings(module);
  add_metrics(module);
  add_mesh(module);
  add_records(module);
}
