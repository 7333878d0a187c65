// SPDX-License-Identifier: MIT
// Ways of a camera for fly-throughs: a circle about what the cameras look at, a smooth curve
// through given ones.
#pragma once

#include <array>
#include <vector>

#include "glint/scene/camera.h"

namespace glint {

struct Orbit {
  Vec3d target;       // what every frame looks at, metres
  Vec3d center;       // of the circle: above or below the target
  Vec3d axis;         // unit, normal of the plane, up in the pictures
  double radius = 0;  // metres
  Vec3d start;        // unit, from the center to the first camera
};

// The circle that fits cameras best: its plane is that of their centres (least squares; level with
// their up direction where they do not span one, or where the plane stands upright), through their
// mean height; its radius their mean distance from the axis. The target is the point nearest to all
// optical axes; where those are nearly parallel, meet behind the cameras or outside of the box
// (`low` to `high`, the scene's bounds), the box's centre. Errors (kBadReference): no camera; all
// stand on the axis.
Orbit fit_orbit(const std::vector<Camera>& cameras, Vec3d low, Vec3d high);

// One turn in `frames` equal steps, the last a step before the first; size and focal length are
// those of `lens`.
std::vector<Camera> orbit_cameras(const Orbit& orbit, const Camera& lens, int frames);

// A curve through the keys, continuous with its first derivative: Catmull-Rom polynomials
// [Catmull74] on knots that are not equally far apart, of the centres and of the quaternions, which
// are normalised again. Size and focal length are those of the first key.
class CameraSpline {
 public:
  // Keys that stand and look like the one before are left out. Errors (kBadReference): fewer than
  // two are left.
  explicit CameraSpline(const std::vector<Camera>& keys);
  // Ascending from 0, one a key: at(knots()[i]) is key i.
  const std::vector<double>& knots() const { return knots_; }
  // t is clamped to the knots' range.
  Camera at(double t) const;
  // Frames at equal distances of t, from the first key to the last.
  std::vector<Camera> frames(int count) const;

 private:
  using Pose = std::array<double, 7>;  // centre, then quaternion w, x, y, z
  Pose pose(std::ptrdiff_t i) const;   // -1 and size(): mirrored at the ends
  double knot(std::ptrdiff_t i) const;

  Camera lens_;
  std::vector<Pose> poses_;
  std::vector<double> knots_;
};

// The lens at another image size: the horizontal field of view is kept, pixels stay square as far
// as they were, what is above and below is added or cut off alike.
Camera with_size(const Camera& camera, ImageSize size);

}  // namespace glint
