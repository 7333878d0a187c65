// SPDX-License-Identifier: MIT
#include "datasets/glassroom/layers.h"

namespace glint::path_tracing {

namespace {

// Takes what is seen in mirrors to where it appears: reflections at their planes, the last first.
class Unfolding {
 public:
  void add(const Surface& mirror) {
    planes_[count_++] = {cast<double>(mirror.position), cast<double>(mirror.normal)};
  }
  Vec3d point(Vec3d p) const {
    for (std::size_t i = count_; i > 0; --i) p = planes_[i - 1].reflected(p);
    return p;
  }
  Vec3d direction(Vec3d w) const {
    for (std::size_t i = count_; i > 0; --i)
      w = w - 2 * dot(w, planes_[i - 1].normal) * planes_[i - 1].normal;
    return w;
  }

 private:
  struct Plane {
    Vec3d point{}, normal{};
    Vec3d reflected(Vec3d p) const { return p - 2 * dot(p - point, normal) * normal; }
  };
  std::array<Plane, kMaxLayers> planes_;
  std::size_t count_ = 0;
};

}  // namespace

Layers layers_along(const RayScene& scene, Vec3f origin, Vec3f direction) {
  Layers found;
  Unfolding unfolding;
  while (found.count < kMaxLayers) {
    const auto surface = scene.intersect(origin, direction, RayMask::kAll);
    if (!surface) break;
    Layer& layer = found.layers[found.count++];
    layer = {
        unfolding.point(cast<double>(surface->position)),
        unfolding.direction(cast<double>(surface->shading_normal)),
        scene.is_glass(*surface),
        scene.is_mirror(*surface)};
    if (!layer.glass && !layer.mirror) break;
    if (layer.mirror) {
      unfolding.add(*surface);
      direction = mirrored(direction, surface->normal);
    }
    origin = RayScene::leave(surface->position, surface->normal, direction);
  }
  return found;
}

}  // namespace glint::path_tracing
