// SPDX-License-Identifier: MIT
// Triangle meshes of the shapes that rooms are built from. All have unit normals per vertex and
// texture coordinates in metres along the surface (scale_uvs turns them into texture periods).
// z is up; lengths in metres, angles in radians.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "datasets/glassroom/trace_scene.h"

namespace glint {

// x_world = rotation * x_local + translation.
struct Pose {
  Mat3f rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3f translation{};
  Vec3f apply(Vec3f local) const { return rotation * local + translation; }
};
Pose translated(Vec3f translation);
Pose yawed(float yaw, Vec3f translation);            // turned about z
Pose compose(const Pose& outer, const Pose& inner);  // outer(inner(x))

// Axis-aligned box; empty until something is included.
struct Bounds {
  Vec3f low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  void include(Vec3f point);
  Vec3f center() const { return 0.5f * (low + high); }
  Vec3f size() const { return high - low; }
  Bounds grown(float margin) const;
  bool contains(const Bounds& other) const;
  bool contains(Vec3f point) const;
  bool overlaps(const Bounds& other) const;
};
Bounds bounds_of(const TraceMesh& mesh);

// Box between two corners, sharp edges.
TraceMesh box_mesh(Vec3f low, Vec3f high);
// Box with its vertical and top edges chamfered by `bevel`: cushions and upholstery.
TraceMesh cushion_mesh(Vec3f low, Vec3f high, float bevel);
// Parallelogram origin + [0,1] u + [0,1] v; faces along cross(u, v).
TraceMesh quad_mesh(Vec3f origin, Vec3f u, Vec3f v);
// Surface of revolution about z of a profile (radius, z), bottom to top; radius 0 closes it.
TraceMesh lathe_mesh(std::span<const Vec2f> profile, int segments);
TraceMesh sphere_mesh(float radius, int segments);
TraceMesh cylinder_mesh(float radius, float height, int segments);  // closed, on z = 0
TraceMesh cone_mesh(float radius, float height, int segments);      // closed, on z = 0
TraceMesh torus_mesh(float ring_radius, float tube_radius, int segments, int sides);
// Round tube along a polyline, open at its ends; radii per point.
TraceMesh tube_mesh(std::span<const Vec3f> path, std::span<const float> radii, int sides);
// Height field of a hanging cloth: width along x, height along z, `folds` waves of `depth` along y.
TraceMesh curtain_mesh(float width, float height, int folds, float depth);

void transform(TraceMesh& mesh, const Pose& pose);
void append(TraceMesh& mesh, const TraceMesh& part, const Pose& pose = {});
// uv * factor + offset: one texture period per 1 / factor metres.
void scale_uvs(TraceMesh& mesh, float factor, Vec2f offset = {});

int add_texture(TraceScene& scene, Image texture);
int add_material(TraceScene& scene, Material material);
void add_mesh(TraceScene& scene, TraceMesh mesh, std::string name, int material);

}  // namespace glint
