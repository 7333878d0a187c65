// SPDX-License-Identifier: MIT
// Axes of the camera that files of normals are stored in.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace glint {

// Factors of x, y, z that lead to OpenCV axes (x right, y down, z forward).
struct Axes {
  std::string_view name;
  std::array<float, 3> to_opencv;
};
inline constexpr std::array<Axes, 3> kAxes = {{
    {"opencv", {1, 1, 1}},
    {"opengl", {1, -1, -1}},         // x right, y up, z to the viewer
    {"stablenormal", {-1, -1, -1}},  // x left, y up, z to the viewer
}};

// One of the names above.
inline const Axes& axes_called(std::string_view name) {
  return *std::ranges::find(kAxes, name, &Axes::name);
}

}  // namespace glint
