// SPDX-License-Identifier: MIT
#include "datasets/glassroom/light_sampling.h"

#include <algorithm>
#include <cmath>

namespace glint::path_tracing {

namespace {

const Material& material_of(const RayScene& scene, const Triangle& triangle) {
  return scene.scene().materials[static_cast<std::size_t>(triangle.material)];
}

}  // namespace

LightSampler::LightSampler(const RayScene& scene) : scene_(scene) {
  std::vector<double> sums;
  double sum = 0;
  for (std::size_t i = 0; i < scene.triangles().size(); ++i) {
    const Triangle& triangle = scene.triangles()[i];
    const float power = luminance(material_of(scene, triangle).emission) * triangle.area;
    if (power <= 0) continue;
    triangles_.push_back(static_cast<int>(i));
    sums.push_back(sum += static_cast<double>(power));
  }
  for (const double s : sums) cumulative_.push_back(static_cast<float>(s / sum));
  total_power_ = static_cast<float>(sum);
}

float LightSampler::pdf_area(Vec3f emission) const { return luminance(emission) / total_power_; }

LightSample LightSampler::sample(Vec2f u) const {
  const auto chosen = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u.x);
  const auto k = static_cast<std::size_t>(chosen - cumulative_.begin());
  const float low = k == 0 ? 0 : cumulative_[k - 1];
  // Stretched back to [0, 1): the point on the triangle stays stratified.
  const float x = std::min((u.x - low) / (cumulative_[k] - low), 1.0f);

  const Triangle& triangle = scene_.triangles()[static_cast<std::size_t>(triangles_[k])];
  // Uniform on the triangle: 1 - sqrt(x) is the first barycentric coordinate.
  const float s = std::sqrt(x);
  const Vec3f position = triangle.p0 + s * (1 - u.y) * triangle.edge1 + s * u.y * triangle.edge2;
  const Vec3f radiance = material_of(scene_, triangle).emission;
  return {position, triangle.normal, radiance, pdf_area(radiance)};
}

}  // namespace glint::path_tracing
