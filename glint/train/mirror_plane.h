// SPDX-License-Identifier: MIT
// Plane mirrors and panes (beyond the paper): a rectangle in the world, and the camera behind it
// that sees what another sees in it.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "glint/scene/camera.h"

namespace glint {

struct MirrorPlane {
  Vec3d center{};                          // world, metres
  Vec3d normal{0, 0, 1}, across{1, 0, 0};  // unit, at a right angle; normal: to where it is seen
  double half_width = 0, half_height = 0;  // metres, along across and up()
  std::array<float, 3> tint{1, 1, 1};      // displayed: what it mirrors, times this
  double likeness = 0;  // correlation of what it should mirror with the photos, at most 1
  double outlined = 0;  // of a pane: agreement of its outlines; 0: they do not tell where it is
  bool pane = false;    // of glass: what it mirrors comes on top of what is seen through it

  Vec3d up() const { return cross(normal, across); }
  // Seen from its other side.
  MirrorPlane turned() const {
    MirrorPlane back = *this;
    back.normal = -normal, back.across = -across;
    return back;
  }
  double signed_distance(Vec3d point) const { return dot(normal, point - center); }
  // Whether the rectangle has it, once it is moved into the plane.
  bool holds(Vec3d point) const {
    return std::abs(dot(point - center, across)) <= half_width &&
           std::abs(dot(point - center, up())) <= half_height;
  }
  // The point behind the plane that a mirror shows it at.
  Vec3d mirrored(Vec3d point) const { return point - (2 * signed_distance(point)) * normal; }
};

// What `camera` sees in the plane, seen from behind it and mirrored left to right: pixel (x, y) of
// the one is pixel (width - 1 - x, y) of the other, at the same depth.
Camera mirrored(const Camera& camera, const MirrorPlane& plane);

// Whether some of the rectangle's front may be in the picture.
bool is_in_view(const MirrorPlane& plane, const Camera& camera);

// As a file has them (mirrors.json); none: an empty list. Errors (kBadPrediction): not such a text,
// numbers that are no rectangle; `file` opens the message.
std::string mirrors_text(const std::vector<MirrorPlane>& planes);
std::vector<MirrorPlane> mirrors_of(const std::string& text, const std::string& file);

}  // namespace glint
