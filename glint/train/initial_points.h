// SPDX-License-Identifier: MIT
// Where surfels start: the scene's points, random ones, or a grid through its bounds.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "glint/scene/scene.h"

namespace glint {

// The scene's points, or `count` uniform random ones in its bounds where it has none. Errors
// (kBadReference): no point lies in front of any training camera.
PointCloud initial_points(const Scene& scene, std::size_t count, std::uint64_t seed);

// Adds a warning where the scene has no points.
void warn_without_points(
    const Scene& scene, const std::string& method, std::vector<std::string>& warnings
);

// The initial cloud of sets that mirrored rays are traced into [Xie25; Na26 supplement]: uniform
// points in each of cells^3 equal boxes of the scene's bounds, colours random up to `brightness`.
struct ReflectionGrid {
  int cells = 32, points_per_cell = 5;
  // Deviation: 32^3 cells are meant for images of 480x270; smaller ones start with as many points a
  // pixel, for more could not be told apart by so few rays. Larger images keep `cells`.
  static constexpr double kPointsPerPixel = 1.264;
  // Deviation: the official codes draw colours up to 1/255, black but for that, and in runs as
  // short as ours GLINT's stays dark (docs/design/tried.md). EnvGS starts as there.
  float brightness = 1;

  template <class V>
  void visit(V&& v) {
    v("reflection_cells", cells, "most cells of the reflection grid along each axis");
    v("reflection_brightness", brightness, "initial colours are random, from 0 to this");
  }
  int cells_for(ImageSize size) const;
  // How many times as far apart points are as with all cells. Deviation: the size at which density
  // control prunes or splits grows with it; otherwise surfels of a coarse grid begin near that size
  // and nearly all of them go (docs/design/tried.md).
  float coarseness(ImageSize size) const;
  PointCloud points(const Scene& scene, std::uint64_t seed) const;
};

}  // namespace glint
