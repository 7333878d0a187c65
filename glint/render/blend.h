// SPDX-License-Identifier: MIT
// Alpha of a hit and front-to-back compositing of any channels [Huang24 Eq. 6, 12; Kerbl23].
#pragma once

#include "glint/core/vec.h"

namespace glint {

// Cut-offs, the same in every op (docs/reference/conventions.md).
inline constexpr float kMaxRho = 9.0f;             // 3 sigma
inline constexpr float kMinAlpha = 1.0f / 255.0f;  // fainter hits are skipped
inline constexpr float kMaxAlpha = 0.99f;
inline constexpr float kMinTransmittance = 1e-4f;  // compositing stops before falling below

// Squared radius where alpha falls below min_alpha, at most max_rho; not positive: never visible.
GLINT_HD float max_rho_of(float opacity, float max_rho = kMaxRho, float min_alpha = kMinAlpha) {
  return min_of(max_rho, 2.0f * log_of(max_of(opacity, 1e-12f) / min_alpha) + 1e-4f);
}

// Gaussian falloff at squared radius rho (units of sigma), 0 to 174, and the clamped alpha.
template <class T>
struct SplatAlpha {
  T gaussian;  // exp(-rho / 2)
  T alpha;     // min(0.99, opacity * gaussian)
};
template <class T>
GLINT_HD SplatAlpha<T> splat_alpha(T opacity, T rho) {
  const T gaussian = exp_bounded(T(-0.5f) * rho);
  return {gaussian, min_of(opacity * gaussian, T(kMaxAlpha))};
}
// Deviation from the official 2DGS kernels, which let gradients through: a clamped alpha is
// constant.
template <class T>
GLINT_HD void splat_alpha_vjp(
    T opacity, const SplatAlpha<T>& value, T dL_dalpha, T& dL_dopacity, T& dL_drho
) {
  const T free = select(opacity * value.gaussian < T(kMaxAlpha), dL_dalpha, T(0));
  dL_dopacity += free * value.gaussian;
  dL_drho += T(-0.5f) * value.alpha * free;
}

// One step of compositing. A ray that has stopped keeps its transmittance with a minus sign, so
// that the two states need one number; its later weights are 0.
template <class T>
struct BlendStep {
  T weight;         // w = alpha T; 0 where the hit does not count
  T transmittance;  // T (1 - alpha) behind the hit
};
// alpha: 0 where the hit does not count. Hits that would take T below min_transmittance stop the
// ray and do not count.
template <class T>
GLINT_HD BlendStep<T> blend_step(T transmittance, T alpha, T min_transmittance) {
  const T next = transmittance * (T(1) - alpha);
  const auto enough = next >= min_transmittance;
  return {keep(enough, alpha * transmittance), select(enough, next, -abs_of(transmittance))};
}

template <class T>
GLINT_HD BlendStep<T> blend_step(T transmittance, T alpha) {
  return blend_step(transmittance, alpha, T(kMinTransmittance));
}

// dL/dalpha of one hit, all channels at once. With s_k = sum over channels of dL/dF f_k (the hit's
// value seen by the loss) and S = sum_k w_k s_k + T_N s_background:
//   dL/dalpha_k = T_k s_k - (S - sum_{i<=k} w_i s_i) / (1 - alpha_k).
// transmittance: before the hit; remaining: S minus the prefix including this hit.
template <class T>
GLINT_HD T blend_alpha_vjp(T transmittance, T alpha, T value, T remaining) {
  return transmittance * value - remaining / (T(1) - alpha);
}

// Depth mapped to [0, 1] for the distortion loss [Huang24 Eq. 13], m = f/(f-n) (1 - n/z), less the
// m of a reference depth, one for all hits of a ray. The distortion sees differences only; moments
// of the differences keep the digits that moments of m, near 1, lose where layers lie centimetres
// apart.
template <class T>
GLINT_HD T distortion_depth(T z, T reference, T near, T far) {
  return far * near / (far - near) * ((z - reference) / (z * reference));
}
template <class T>
GLINT_HD T distortion_depth_vjp(T z, T near, T far, T dL_dm) {
  return dL_dm * far * near / ((far - near) * z * z);
}
// Distortion of one ray from its moments: sum_{j<i} w_i w_j (m_i - m_j)^2 = A M2 - M1^2 with
// A = sum w, M1 = sum w m, M2 = sum w m^2.
template <class T>
GLINT_HD T distortion(T a, T m1, T m2) {
  return max_of(a * m2 - m1 * m1, T(0));
}
// Derivatives with respect to one hit's weight and depth m, per unit of dL/ddistortion.
template <class T>
GLINT_HD T distortion_dweight(T m, T a, T m1, T m2) {
  return fma_of(m, fma_of(m, a, T(-2) * m1), m2);
}
template <class T>
GLINT_HD T distortion_dm(T weight, T m, T a, T m1) {
  return T(2) * weight * (m * a - m1);
}

// Depth expected from the raw sum: D / A, 0 where nothing was hit.
template <class T>
GLINT_HD T expected_depth(T depth_sum, T alpha) {
  return select(alpha > T(1e-6f), depth_sum / max_of(alpha, T(1e-6f)), T(0));
}
template <class T>
GLINT_HD void expected_depth_vjp(T depth_sum, T alpha, T dL_dz, T& dL_ddepth_sum, T& dL_dalpha) {
  const T inverse = select(alpha > T(1e-6f), T(1) / max_of(alpha, T(1e-6f)), T(0));
  dL_ddepth_sum += dL_dz * inverse;
  dL_dalpha += -(dL_dz * depth_sum * inverse * inverse);
}

}  // namespace glint
