// SPDX-License-Identifier: MIT
// Radiance at glass [Na26 Eq. 5-10], each function with its vjp. Directions: d is the unit camera
// ray (away from the camera), so the paper's w_o = -d.
#pragma once

#include "glint/core/vec.h"
#include "glint/render/tone.h"

namespace glint {

inline constexpr float kGlassF0 = 0.04f;  // reflectance of glass at normal incidence

// Whether a surface counts as a pane, where that is yes or no.
GLINT_HD bool is_glass(float transparency) { return transparency > 0.5f; }

// Schlick's Fresnel term [Na26 Eq. 6]: F0 + (1 - F0)(1 - c)^5, c = max(0, n.w_o).
template <class T>
GLINT_HD T schlick(T f0, T cosine) {
  const T m = T(1) - max_of(cosine, T(0)), m2 = m * m;
  return f0 + (T(1) - f0) * (m2 * m2 * m);
}
template <class T>
GLINT_HD T schlick_vjp(T f0, T cosine, T dL_df) {
  const T m = T(1) - cosine, m2 = m * m;
  return keep(cosine > T(0), T(-5) * (T(1) - f0) * (m2 * m2) * dL_df);
}

// Share of mirrored light k_s = s + (1 - s) F [Na26 Eq. 7] of specularity s.
template <class T>
GLINT_HD T mirrored_share(T specular, T fresnel) {
  return specular + (T(1) - specular) * fresnel;
}
template <class T>
GLINT_HD void mirrored_share_vjp(T specular, T fresnel, T dL_dk, T& dL_dspecular, T& dL_dfresnel) {
  dL_dspecular += dL_dk * (T(1) - fresnel);
  dL_dfresnel += dL_dk * (T(1) - specular);
}

// The mirrored direction w_r = 2 (n.w_o) n - w_o = d - 2 (n.d) n [Na26 Eq. 9].
template <class T>
GLINT_HD Vec3<T> mirrored_direction(Vec3<T> d, Vec3<T> n) {
  return d - (T(2) * dot(n, d)) * n;
}
template <class T>
GLINT_HD void mirrored_direction_vjp(Vec3<T> d, Vec3<T> n, Vec3<T> dL_dw, Vec3<T>& dL_dn) {
  dL_dn += (T(-2) * dot(n, dL_dw)) * d + (T(-2) * dot(n, d)) * dL_dw;
}

// Outgoing radiance [Na26 Eq. 5, 8, 10]. Both the opaque and the transparent branch carry the same
// k_s and reflection, so
//   L_o = (1 - t) L_opaque + t L_transparent = (1 - k_s) ((1 - t) L_intr + t L_trans) + k_s L_refl.
template <class T>
struct GlassRadiance {
  Vec3<T> interface, transmission, reflection;
  T transparency, mirrored;  // t, k_s
};
template <class T>
GLINT_HD Vec3<T> outgoing_radiance(const GlassRadiance<T>& p) {
  const Vec3<T> base = (T(1) - p.transparency) * p.interface + p.transparency * p.transmission;
  return (T(1) - p.mirrored) * base + p.mirrored * p.reflection;
}
template <class T>
GLINT_HD GlassRadiance<T> outgoing_radiance_vjp(const GlassRadiance<T>& p, Vec3<T> g) {
  const T through = T(1) - p.mirrored;
  const Vec3<T> base = (T(1) - p.transparency) * p.interface + p.transparency * p.transmission;
  return {
      (through * (T(1) - p.transparency)) * g,
      (through * p.transparency) * g,
      p.mirrored * g,
      through * dot(g, p.transmission - p.interface),
      dot(g, p.reflection - base)};
}

// Beyond the paper: layers and picture are values as displayed (sRGB), and the layers' light is
// added where light adds, in linear values. Where t and k_s are 0 nothing changes.
template <class T>
GLINT_HD GlassRadiance<T> in_linear_light(const GlassRadiance<T>& p) {
  return {
      linear_of_srgb(p.interface),
      linear_of_srgb(p.transmission),
      linear_of_srgb(p.reflection),
      p.transparency,
      p.mirrored};
}
template <class T>
GLINT_HD Vec3<T> outgoing_displayed(const GlassRadiance<T>& p) {
  return srgb_of_linear(outgoing_radiance(in_linear_light(p)));
}
template <class T>
GLINT_HD GlassRadiance<T> outgoing_displayed_vjp(const GlassRadiance<T>& p, Vec3<T> g) {
  const GlassRadiance<T> linear = in_linear_light(p);
  const GlassRadiance<T> dL_dlinear =
      outgoing_radiance_vjp(linear, srgb_of_linear_vjp(outgoing_radiance(linear), g));
  return {
      linear_of_srgb_vjp(p.interface, dL_dlinear.interface),
      linear_of_srgb_vjp(p.transmission, dL_dlinear.transmission),
      linear_of_srgb_vjp(p.reflection, dL_dlinear.reflection),
      dL_dlinear.transparency,
      dL_dlinear.mirrored};
}
// A layer's part of a displayed value, when its light has this weight in the sum (the metrics'
// true components are made so, docs/reference/metrics.md); 0 where the picture is black.
template <class T>
GLINT_HD T displayed_part(T picture, T layer, T weight) {
  const T sum = linear_of_srgb(picture);
  return sum > T(0) ? picture * (weight * linear_of_srgb(layer) / sum) : T(0);
}

}  // namespace glint
