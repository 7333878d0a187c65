// SPDX-License-Identifier: MIT
// Area lights: points on emitting triangles, chosen in proportion to power, so that the density per
// area is emitted luminance over its integral. Triangles emit on both sides.
#pragma once

#include <span>
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
  bool empty() const { return triangles_.empty(); }
  LightSample sample(Vec2f u) const;
  // Density of sample() at a point of a surface with this emission.
  float pdf_area(Vec3f emission) const;

 private:
  const RayScene& scene_;
  std::vector<int> triangles_;
  std::vector<float> cumulative_;  // of the choice, ends at 1
  float total_power_ = 0;          // luminance x area
};

// Rec. 709 luminance of linear RGB.
inline float luminance(Vec3f rgb) { return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z; }

}  // namespace glint::path_tracing
