// SPDX-License-Identifier: MIT
#include "datasets/glassroom/light_sampling.h"

#include <algorithm>
#include <cmath>

namespace glint::path_tracing {

namespace {

constexpr int kParts = 256;  // a power of two: exact in float

const Material& material_of(const RayScene& scene, const Triangle& triangle) {
  return scene.scene().materials[static_cast<std::size_t>(triangle.material)];
}

}  // namespace

LightSampler::LightSampler(const RayScene& scene) {
  std::vector<double> sums;
  double sum = 0;
  for (const Triangle& triangle : scene.triangles()) {
    const Vec3f radiance = material_of(scene, triangle).emission;
    const float power = luminance(radiance) * triangle.area;
    if (power <= 0) continue;
    lights_.push_back({triangle.p0, triangle.edge1, triangle.edge2, triangle.normal, radiance});
    sums.push_back(sum += static_cast<double>(power));
  }
  total_power_ = static_cast<float>(sum);
  for (Light& light : lights_) light.pdf_area = pdf_area(light.radiance);
  for (const double s : sums) cumulative_.push_back(static_cast<float>(s / sum));
  for (int i = 0; i < kParts && !empty(); ++i) {
    const float low = static_cast<float>(i) / kParts;
    const auto at = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, low);
    first_.push_back(static_cast<std::uint32_t>(at - cumulative_.begin()));
  }
}

float LightSampler::pdf_area(Vec3f emission) const { return luminance(emission) / total_power_; }

// The first light whose sum is above u. Most parts hold one or two.
std::size_t LightSampler::choose(float u) const {
  std::size_t k = first_[static_cast<std::size_t>(u * kParts)];
  while (k + 1 < cumulative_.size() && cumulative_[k] <= u) ++k;
  return k;
}

LightSample LightSampler::sample(Vec2f u) const {
  const std::size_t k = choose(u.x);
  const float low = k == 0 ? 0 : cumulative_[k - 1];
  // Stretched back to [0, 1): the point on the triangle stays stratified.
  const float x = std::min((u.x - low) / (cumulative_[k] - low), 1.0f);
  // Uniform on the triangle: 1 - sqrt(x) is the first barycentric coordinate.
  const float s = std::sqrt(x);
  const Light& light = lights_[k];
  const Vec3f position = light.p0 + s * (1 - u.y) * light.edge1 + s * u.y * light.edge2;
  return {position, light.normal, light.radiance, light.pdf_area};
}

}  // namespace glint::path_tracing
