// SPDX-License-Identifier: MIT
// JSON as Python has it: dict, list, str, int, float, bool, None.
#pragma once

#include <pybind11/pybind11.h>

#include "glint/core/config.h"

namespace glint::python {

// Numbers that are not finite stay what they are. Text that is not UTF-8 gets replacement
// characters.
pybind11::object to_python(const Json& json);

pybind11::str text_to_python(std::string_view text);
pybind11::list texts_to_python(const std::vector<std::string>& texts);

}  // namespace glint::python
