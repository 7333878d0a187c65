// SPDX-License-Identifier: MIT
// A TraceScene made ready for rays: Embree's BVH over all triangles, and the surface at a hit. Thin
// glass is a geometry of its own, so that rays can ignore it and shadow rays can pass through it.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "datasets/glassroom/bsdf.h"
#include "datasets/glassroom/trace_scene.h"

namespace glint::path_tracing {

// All that a hit needs, in two cache lines: the first for the plane, the second for the vertices.
struct alignas(128) Triangle {
  Vec3f p0, edge1, edge2;  // metres
  Vec3f normal;            // unit, by the right-hand rule
  float area = 0;          // square metres
  int mesh = 0, material = 0;
  bool smooth = false;           // has shading normals
  std::array<Vec3f, 3> normals;  // of the vertices, where smooth
  std::array<Vec2f, 3> uvs;      // of the vertices, or zero
};
static_assert(sizeof(Triangle) == 128);

enum class RayMask : unsigned { kOpaque = 1, kGlass = 2, kAll = 3 };

// Of a smooth surface.
inline Vec3f mirrored(Vec3f direction, Vec3f normal) {
  return direction - 2 * dot(direction, normal) * normal;
}

// What a ray met. Both normals are on the side of the ray's origin.
struct Surface {
  Vec3f position;  // on the triangle's plane
  Vec3f normal;    // geometric
  Vec3f shading_normal;
  Vec2f uv;
  float t = 0;  // in units of |direction|
  int triangle = 0, material = 0, mesh = 0;
};

class RayScene {
 public:
  // Keeps a reference to `scene`. Errors (kBadReference): indices out of range, arrays of different
  // lengths, values not finite, textures without three channels. (kEnvironment): Embree fails.
  explicit RayScene(const TraceScene& scene);
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;
  ~RayScene();

  // Closest hit with t > 0. The texels of albedo() are on their way when it returns.
  std::optional<Surface> intersect(Vec3f origin, Vec3f direction, RayMask mask) const;

  // Straight-line transmittance between two points off all surfaces (see leave): 0 behind anything
  // opaque, otherwise the product over panes of (1 - R) tint.
  Vec3f transmittance(Vec3f from, Vec3f to) const;
  bool occluded(Vec3f from, Vec3f to) const;  // by opaque surfaces; ends excluded

  // A point of a plane moved off it, to the side that `direction` leaves by: where rays start and
  // end.
  static Vec3f leave(Vec3f position, Vec3f normal, Vec3f direction);

  Vec3f albedo(const Surface& surface) const;  // linear, textured
  const Material& material(const Surface& surface) const {
    return scene_.materials[static_cast<std::size_t>(surface.material)];
  }
  bool is_glass(const Surface& surface) const {
    return material(surface).kind == MaterialKind::kThinDielectric;
  }
  bool is_mirror(const Surface& surface) const {
    return material(surface).kind == MaterialKind::kMirror;
  }
  const MaterialModel& model(const Surface& surface) const {
    return models_[static_cast<std::size_t>(surface.material)];
  }
  std::span<const Triangle> triangles() const { return triangles_; }
  const TraceScene& scene() const { return scene_; }

 private:
  RTCRayHit closest(Vec3f origin, Vec3f direction, RayMask mask) const;
  void add_triangles(bool glass);
  void attach(std::size_t first, std::size_t count, RayMask mask);
  static void pass_glass(const RTCFilterFunctionNArguments* arguments);

  const TraceScene& scene_;
  std::vector<MaterialModel> models_;
  std::vector<ImageView> textures_;  // of materials; empty: none
  std::vector<Triangle> triangles_;  // opaque ones first
  std::size_t num_opaque_ = 0;
  RTCDevice device_ = nullptr;
  RTCScene bvh_ = nullptr;
};

}  // namespace glint::path_tracing
