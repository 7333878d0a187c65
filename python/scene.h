// SPDX-License-Identifier: MIT
// Cameras, views and scenes as Python sees them.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "glint/scene/scene.h"

namespace glint::python {

using ScenePointer = std::shared_ptr<const Scene>;

// A view lives in its scene.
struct ViewOfScene {
  ScenePointer scene;
  const View* view;
};

struct SceneHandle {
  ScenePointer scene;
};

void add_camera(pybind11::module_& module);
void add_scene(pybind11::module_& module);

}  // namespace glint::python
