// SPDX-License-Identifier: MIT
// A trained method, or one in training, as Python sees it.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <string>

#include "glint/method.h"
#include "python/scene.h"

namespace glint::python {

// One thread renders or trains at a time. Null method: its training ended by an exception.
class Run {
 public:
  Run(std::string id, std::string folder, RunOptions options, ScenePointer scene)
      : method_id(std::move(id)),
        folder(std::move(folder)),
        options(options),
        scene(std::move(scene)) {}

  // What has ended well, and is kept.
  void keep(std::unique_ptr<Method> method);
  // f(method), alone. Errors (kUsage): no method.
  template <class F>
  auto with_method(F&& f) {
    const std::lock_guard lock(mutex);
    return f(checked());
  }

  const std::string method_id, folder;  // folder empty: in memory alone
  const RunOptions options;
  const ScenePointer scene;
  std::mutex mutex;
  Method* method = nullptr;

 private:
  Method& checked() const;
  std::unique_ptr<Method> kept_;
};

using RunPointer = std::shared_ptr<Run>;

void add_run(pybind11::module_& module);
void add_training(pybind11::module_& module);

// The device is chosen when the first method needs it, unless set_device() did; methods and
// warnings are for people who ask.
void choose_device_once();
void add_settings(pybind11::module_& module);

}  // namespace glint::python
