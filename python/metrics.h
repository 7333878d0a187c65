// SPDX-License-Identifier: MIT
// Scores of arrays.
#pragma once

#include <pybind11/pybind11.h>

namespace glint::python {

void add_metrics(pybind11::module_& module);  // of images and maps
void add_mesh(pybind11::module_& module);
void add_records(pybind11::module_& module);

}  // namespace glint::python
