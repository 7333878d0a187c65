// SPDX-License-Identifier: MIT
// Isotropic GGX microfacets in the local frame (surface normal = +z), [Walter07]; height-correlated
// Smith shadowing and masking, [Heitz14]; sampling of visible normals by spherical caps,
// [Dupuy-Benyoub23]. `alpha` is the GGX width; all directions are unit and point away from the
// surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glint/core/vec.h"

namespace glint::path_tracing {

inline constexpr float kPi = std::numbers::pi_v<float>;

// [Walter07] Eq. 33 as a function of the normal's cosine.
inline float ggx_density(float cos_h, float alpha) {
  const float a2 = alpha * alpha;
  const float d = cos_h * cos_h * (a2 - 1) + 1;
  return a2 / (kPi * d * d);
}

// [Heitz14] Eq. 72: Smith's Lambda.
inline float ggx_lambda(float cosine, float alpha) {
  const float c2 = cosine * cosine;
  const float tan2 = std::max(0.0f, 1 - c2) / c2;
  return 0.5f * (std::sqrt(1 + alpha * alpha * tan2) - 1);
}

// Masking of one direction, and of both with correlated heights, [Heitz14] Eqs. 43 and 99.
inline float ggx_g1(float cosine, float alpha) { return 1 / (1 + ggx_lambda(cosine, alpha)); }
inline float ggx_g2(float cos_o, float cos_i, float alpha) {
  return 1 / (1 + ggx_lambda(cos_o, alpha) + ggx_lambda(cos_i, alpha));
}

// A normal visible from `wo`, with density D_visible(h) = G1(wo) D(h) max(0, wo.h) / wo.z.
inline Vec3f sample_visible_normal(Vec3f wo, float alpha, Vec2f u) {
  const Vec3f v = normalize(Vec3f{alpha * wo.x, alpha * wo.y, wo.z});
  const float phi = 2 * kPi * u.x;
  const float z = (1 - u.y) * (1 + v.z) - v.z;
  const float r = std::sqrt(std::clamp(1 - z * z, 0.0f, 1.0f));
  const Vec3f h = Vec3f{r * std::cos(phi), r * std::sin(phi), z} + v;
  return normalize(Vec3f{alpha * h.x, alpha * h.y, std::max(h.z, 1e-7f)});
}

// Density of wi = reflect(wo, h) with h from sample_visible_normal, per solid angle: the Jacobian
// 1 / (4 wo.h) cancels the projection.
inline float ggx_reflection_pdf(Vec3f wo, Vec3f h, float alpha) {
  return ggx_g1(wo.z, alpha) * ggx_density(h.z, alpha) / (4 * wo.z);
}

}  // namespace glint::path_tracing
