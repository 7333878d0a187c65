// SPDX-License-Identifier: MIT
// Per-surfel appearance from anisotropic lobes (lobe_appearance.h): the formulas, each with its
// vjp, and the loops over visible surfels.
#pragma once

#include <cstdint>

#include "glint/core/kernel.h"
#include "glint/render/activations.h"
#include "glint/render/pinhole.h"
#include "glint/render/transport.h"

namespace glint {

// log(1 + e^x) and its slope, the sigmoid.
template <class T>
GLINT_HD T softplus(T x) {
  return max_of(x, T(0)) + log_of(T(1) + exp_fast(-abs_of(x)));
}
template <class T>
GLINT_HD T softplus_vjp(T x, T dL_dvalue) {
  return dL_dvalue * sigmoid(x);
}

// Axis of a lobe and its two tangents.
template <class T>
struct LobeFrame {
  Vec3<T> axis, tangent_theta, tangent_phi;
};
template <class T>
GLINT_HD LobeFrame<T> lobe_frame(T sin_theta, T cos_theta, T sin_phi, T cos_phi) {
  return {
      {sin_theta * cos_phi, sin_theta * sin_phi, cos_theta},
      {cos_theta * cos_phi, cos_theta * sin_phi, -sin_theta},
      {-sin_phi, cos_phi, T(0)}};
}

// One lobe's numbers: two amplitudes and the sharpness along each tangent, before softplus.
inline constexpr int kLobeNumbers = 4;
// a relu(w.r) exp(-softplus(lambda - 1) (w_l.r)^2 - softplus(mu - 1) (w_m.r)^2) for both a.
template <class T>
GLINT_HD T lobe_strength(const LobeFrame<T>& frame, const T numbers[kLobeNumbers], Vec3<T> r) {
  const T along = max_of(dot(frame.axis, r), T(0));
  const T l = softplus(numbers[2] - T(1)) * square(dot(frame.tangent_theta, r));
  const T m = softplus(numbers[3] - T(1)) * square(dot(frame.tangent_phi, r));
  return along * exp_fast(-l - m);
}
template <class T>
GLINT_HD Vec2<T> lobe(const LobeFrame<T>& frame, const T numbers[kLobeNumbers], Vec3<T> r) {
  const T strength = lobe_strength(frame, numbers, r);
  return {numbers[0] * strength, numbers[1] * strength};
}
// r is a constant. Writes dL/d(numbers).
template <class T>
GLINT_HD void lobe_vjp(
    const LobeFrame<T>& frame,
    const T numbers[kLobeNumbers],
    Vec3<T> r,
    Vec2<T> dL_dlobe,
    T dL_dnumbers[kLobeNumbers]
) {
  const T strength = lobe_strength(frame, numbers, r);
  const T g = (dL_dlobe.x * numbers[0] + dL_dlobe.y * numbers[1]) * strength;
  dL_dnumbers[0] = dL_dlobe.x * strength;
  dL_dnumbers[1] = dL_dlobe.y * strength;
  dL_dnumbers[2] = softplus_vjp(numbers[2] - T(1), -g * square(dot(frame.tangent_theta, r)));
  dL_dnumbers[3] = softplus_vjp(numbers[3] - T(1), -g * square(dot(frame.tangent_phi, r)));
}

// sin and cos of a unit direction's coordinates times 1 and 2, 12 numbers.
inline constexpr int kDirectionOctaves = 2, kEncodedDirection = 6 * kDirectionOctaves;
GLINT_HD void encode_direction(Vec3f d, float* to) {
  for (int octave = 0; octave < kDirectionOctaves; ++octave)
    for (int axis = 0; axis < 3; ++axis) {
      const float x = static_cast<float>(1 << octave) * d[axis];
      to[6 * octave + axis] = sinf(x);
      to[6 * octave + 3 + axis] = cosf(x);
    }
}

// Where the direction of a surfel comes from, a constant of the loss.
struct LobeView {
  const float* means;  // [N][3], world
  Vec3f eye;

  GLINT_HD Vec3f at(std::size_t surfel) const {  // unit, from the eye
    const Vec3f d = get3(means, surfel) - eye;
    return (1 / max_of(length(d), 1e-12f)) * d;
  }
};

// Whether the sphere around a surfel's centre that holds its 3-sigma ellipse meets the pyramid of
// the image, widened by what the screen-space low-pass reaches.
struct MarkInPyramid {
  static constexpr float kMargin = 3;  // pixels; the low-pass reaches sqrt(9 / 2)

  const float *means, *log_scales;  // [N][3] metres, [N][2]
  Pinhole<float> camera;
  Mat3f rotation;  // camera from world
  Vec3f translation;
  std::uint8_t* visible;  // [N]

  // On the inner side of a plane through the eye with normal (a, b) along (one axis, depth).
  GLINT_HD static bool meets(float a, float b, float x, float z, float radius) {
    return a * x + b * z > -radius * sqrtf(a * a + b * b);
  }
  GLINT_HD static bool between(float f, float low, float high, float x, float z, float radius) {
    return meets(f, low, x, z, radius) && meets(-f, high, x, z, radius);
  }
  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f m = rotation * get3(means, i) + translation;
    const float radius = 3 * exp_fast(max_of(log_scales[2 * i], log_scales[2 * i + 1]));
    const float right = static_cast<float>(camera.width) - camera.cx;
    const float bottom = static_cast<float>(camera.height) - camera.cy;
    const bool x = between(camera.fx, camera.cx + kMargin, right + kMargin, m.x, m.z, radius);
    const bool y = between(camera.fy, camera.cy + kMargin, bottom + kMargin, m.y, m.z, radius);
    visible[i] = m.z > -radius && x && y ? 1 : 0;
  }
};

// Rows of visible surfels (GatherRows) back. Every surfel at most once.
struct AddToRows {
  const float* from;             // [M][width]
  const std::uint32_t* surfels;  // [M]
  std::size_t width;
  float* rows;  // [N][width], added to
  GLINT_HD void operator()(std::size_t i) const {
    rows[surfels[i / width] * width + i % width] += from[i];
  }
};

struct LobeInputs {
  const std::uint32_t* surfels;  // [M]
  LobeView view;
  const LobeFrame<float>* frames;  // [lobes]
  std::size_t lobes, width;        // of a row of inputs
  const float* numbers;            // [M][lobes][4]
  float* inputs;                   // [M][width]

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f direction = view.at(surfels[i]);
    float* to = inputs + i * width;
    for (std::size_t l = 0; l < lobes; ++l) {
      const Vec2f value = lobe(frames[l], numbers + (i * lobes + l) * kLobeNumbers, direction);
      *to++ = value.x;
      *to++ = value.y;
    }
    for (int axis = 0; axis < 3; ++axis) *to++ = direction[axis];
    encode_direction(direction, to);
  }
};
struct LobeInputsVjp {
  const std::uint32_t* surfels;
  LobeView view;
  const LobeFrame<float>* frames;
  std::size_t lobes, width;
  const float *numbers, *dL_dinputs;
  float* dL_dnumbers;  // [M][lobes][4]

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f direction = view.at(surfels[i]);
    const float* g = dL_dinputs + i * width;
    for (std::size_t l = 0; l < lobes; ++l) {
      const std::size_t at = (i * lobes + l) * kLobeNumbers;
      lobe_vjp(frames[l], numbers + at, direction, {g[2 * l], g[2 * l + 1]}, dL_dnumbers + at);
    }
  }
};

// Rows of three with visible[row] == 0 become zero.
struct ClearUnseen {
  const std::uint8_t* visible;
  float* rows;
  GLINT_HD void operator()(std::size_t i) const {
    if (visible[i / 3] == 0) rows[i] = 0;
  }
};

using LobeAppearanceKernels =
    KernelList<ClearUnseen, MarkInPyramid, AddToRows, LobeInputs, LobeInputsVjp>;

}  // namespace glint
