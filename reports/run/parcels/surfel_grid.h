// SPDX-License-Identifier: MIT
// Where the numbers of a packed surfel lie on their grids. What decides how many bits a number has
// is computed in whole numbers, so that it is the same on every machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "glint/scene/camera.h"

namespace glint {

inline constexpr const char* kOnGrids = "grids";     // kinds of packed surfels
inline constexpr const char* kAsTheyAre = "floats";  // without loss
inline constexpr int kZBits = 16,
                     kMostCellBits = 36;  // of a position, an axis: in Z-order, at most

// 64 * 2^(i / 4).
inline constexpr std::int64_t kQuarterPowers[] = {64, 76, 91, 108};

inline std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a / b - static_cast<std::int64_t>(a % b != 0 && (a < 0) != (b < 0));
}

// 64 * 2^(quarters / 4), to about a percent, within [least, most].
inline std::int64_t quarter_power(std::int64_t quarters, std::int64_t least, std::int64_t most) {
  const std::int64_t octave = floor_div(quarters, 4);
  if (octave > 40) return most;
  if (octave < -6) return least;
  const std::int64_t power = kQuarterPowers[quarters - 4 * octave];
  const std::int64_t value = octave >= 0 ? power << octave : power >> -octave;
  return value < least ? least : (value > most ? most : value);
}

// Cells along the two axes of the octahedron that normals are looked up on, for a surfel whose
// larger scale is 2^(scale / levels) metres. `fineness`: in quarters of octaves.
inline std::int64_t normal_cells(std::int64_t scale, int levels, std::int64_t fineness) {
  return quarter_power(floor_div(4 * scale, levels) + fineness, 16, 1 << 16);
}

// Steps of the rotation within the plane, over half a turn, of a surfel whose scales differ by so
// many of their steps: the longer it is, the more; 1: it is round. `fineness`: steps for scales a
// factor of two apart.
inline std::int64_t angle_steps(std::int64_t scale_difference, int levels, std::int64_t fineness) {
  const std::int64_t difference = scale_difference < 0 ? -scale_difference : scale_difference;
  const std::int64_t beyond = difference - levels;
  if (beyond <= 0) return 1 + fineness * difference / levels;
  const std::int64_t power = quarter_power(floor_div(4 * beyond, levels), 64, 64 << 8);
  return std::min<std::int64_t>((1 + fineness) * power / 64, 1 << 16);
}

struct OctahedralCell {
  std::int64_t x = 0, y = 0;
};

// The unit vector at a cell's centre.
inline Vec3<double> octahedral_normal(OctahedralCell cell, std::int64_t cells) {
  const auto centre = [&](std::int64_t i) {
    return (2 * static_cast<double>(i) + 1) / static_cast<double>(cells) - 1;
  };
  double x = centre(cell.x), y = centre(cell.y);
  const double z = 1 - std::abs(x) - std::abs(y);
  if (z < 0) {
    const double fold = std::abs(x);
    x = std::copysign(1 - std::abs(y), x);
    y = std::copysign(1 - fold, y);
  }
  return normalize(Vec3<double>{x, y, z});
}

inline OctahedralCell octahedral_cell(Vec3<double> n, std::int64_t cells) {
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  double x = n.x / sum, y = n.y / sum;
  if (n.z < 0) {
    const double fold = std::abs(x);
    x = std::copysign(1 - std::abs(y), x);
    y = std::copysign(1 - fold, y);
  }
  const auto cell = [&](double value) {
    const auto i = static_cast<std::int64_t>((value + 1) / 2 * static_cast<double>(cells));
    return i < 0 ? 0 : (i >= cells ? cells - 1 : i);
  };
  return {cell(x), cell(y)};
}

// With the size of its grid; of the first surfel, nothing is known.
struct GridPlace {
  OctahedralCell cell;
  std::int64_t cells = 1;
};

// A cell of one grid on another.
inline OctahedralCell on_grid(OctahedralCell cell, std::int64_t from, std::int64_t to) {
  const auto place = [&](std::int64_t i) { return (2 * i + 1) * to / (2 * from); };
  return {place(cell.x), place(cell.y)};
}

// Axes of a plane with that normal, right-handed with it.
struct PlaneAxes {
  Vec3<double> u, v;
};
inline PlaneAxes plane_axes(Vec3<double> n) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

}  // namespace glint
