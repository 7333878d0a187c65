// SPDX-License-Identifier: MIT
// Fresnel reflectance of smooth interfaces. `cos_i` is the cosine of the angle of incidence on the
// side of vacuum, in [0, 1]; `ior` >= 1 is the index of refraction of the other side.
#pragma once

#include <algorithm>
#include <cmath>

#include "glint/core/vec.h"

namespace glint::path_tracing {

struct PolarizedReflectance {
  float s, p;  // electric field perpendicular and parallel to the plane of incidence
};

// Fresnel's equations for a dielectric, entered from vacuum (no total reflection).
inline PolarizedReflectance fresnel_dielectric_polarized(float cos_i, float ior) {
  const float sin2_t = (1 - cos_i * cos_i) / (ior * ior);
  const float cos_t = std::sqrt(std::max(0.0f, 1 - sin2_t));
  const float s = (cos_i - ior * cos_t) / (cos_i + ior * cos_t);
  const float p = (ior * cos_i - cos_t) / (ior * cos_i + cos_t);
  return {s * s, p * p};
}

inline float fresnel_dielectric(float cos_i, float ior) {
  const PolarizedReflectance r = fresnel_dielectric_polarized(cos_i, ior);
  return 0.5f * (r.s + r.p);
}

// Schlick's approximation; `f0` is the reflectance at normal incidence.
inline Vec3f fresnel_schlick(Vec3f f0, float cos_i) {
  const float m = std::max(0.0f, 1 - cos_i);
  const float m5 = (m * m) * (m * m) * m;
  return (1 - m5) * f0 + m5 * Vec3f{1, 1, 1};
}

}  // namespace glint::path_tracing
