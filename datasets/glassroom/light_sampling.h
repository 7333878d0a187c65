// SPDX-License-Identifier: MIT
// Area lights: points on emitting triangles, chosen in proportion to power, so that the density per
// area is emitted luminance over its integral. Triangles emit on both sides.
#pragma once

#include <cstdint>
#include <vector>

#include "datasets/glassroom/ray_scene.h"

namespace glint::path_tracing {

struct LightSample {
  Vec3f position, normal, radiance;
  float pdf_area = 0;  // per square metre, over all lights
};

class LightSampler {
 public:
  explicit LightSampler(const RayScene& scene);
  bool empty() const { return lights_.empty(); }
  LightSample sample(Vec2f u) const;
  // Density of sample() at a point of a surface with this emission.
  float pdf_area(Vec3f emission) const;

 private:
  struct Light {
    Vec3f p0, edge1, edge2, normal, radiance;
    float pdf_area = 0;
  };
  std::size_t choose(float u) const;

  std::vector<Light> lights_;      // triangles
  std::vector<float> cumulative_;  // of the choice, ends at 1
  // Of each of as many equal parts of [0, 1): the first light that a number in it may choose.
  std::vector<std::uint32_t> first_;
  float total_power_ = 0;  // luminance x area
};

// Rec. 709 luminance of linear RGB.
inline float luminance(Vec3f rgb) { return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z; }

}  // namespace glint::path_tracing
