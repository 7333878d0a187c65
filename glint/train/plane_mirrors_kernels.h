// SPDX-License-Identifier: MIT
// PlaneMirrors, pixel by pixel. Maps of the camera in the mirror are mirrored left to right.
#pragma once

#include "glint/core/kernel.h"
#include "glint/render/blend.h"
#include "glint/render/pinhole.h"
#include "glint/render/transport.h"

namespace glint {

GLINT_HD std::size_t left_to_right(std::size_t i, int width) {
  const auto across = static_cast<std::size_t>(width);
  const std::size_t x = i % across;
  return i - x + (across - 1 - x);
}

// Which pixels see the front of a rectangle with nothing before it, how far away, what share of the
// light there is mirrored, and where what the camera in the mirror sees begins.
struct SeeMirror {
  static constexpr float kNever = 1e30f;  // metres
  // Of its depth: a thing that is nearer is before it. What the photos of a mirror draw off its
  // plane is not, and then follows the depth prior alone.
  static constexpr float kBefore = 0.85f;

  Pinhole<float> camera;
  Vec3f center, normal, across, up;    // camera space
  float half_width, half_height, gap;  // metres
  float f0;                            // of the share; 1: all
  const float* depth;                  // [H][W][1] of the first surface; 0: none
  float *seen, *plane_depth;           // [H][W][1] the share; metres; 0: not seen
  float* limit;                        // [H][W][1] of the camera in the mirror

  GLINT_HD void operator()(std::size_t i) const {
    const int at = static_cast<int>(i), w = camera.width;
    const Vec3f ray = camera.ray(at % w, at / w);
    const float facing = dot(normal, ray);
    const float z = facing < 0 ? dot(normal, center) / facing : 0.0f;
    const Vec3f p = z * ray - center;
    const float x = dot(p, across), y = dot(p, up);
    const bool inside =
        z > 0 && x * x <= half_width * half_width && y * y <= half_height * half_height;
    const bool hidden = depth[i] > 0 && depth[i] < kBefore * z - gap;
    const bool sees = inside && !hidden;
    seen[i] = sees ? schlick(f0, -facing / length(ray)) : 0.0f;
    plane_depth[i] = sees ? z : 0.0f;
    limit[left_to_right(i, w)] = sees ? z + gap : kNever;
  }
};

// What a mirror shows, in the picture, at its share.
struct PutMirror {
  int width;
  Vec3f tint;
  const float *seen, *mirrored;
  float* image;
  GLINT_HD void operator()(std::size_t i) const {
    if (seen[i] <= 0) return;
    const Vec3f other = seen[i] < 1 ? (1 - seen[i]) * get3(image, i) : Vec3f{};
    put3(image, i, other + seen[i] * hadamard(tint, get3(mirrored, left_to_right(i, width))));
  }
};
// Takes the gradient of its pixels out of the picture's.
struct PutMirrorVjp {
  int width;
  Vec3f tint;
  const float* seen;
  float *dL_dimage, *dL_dmirrored;
  GLINT_HD void operator()(std::size_t i) const {
    const bool sees = seen[i] > 0;
    const Vec3f g = sees ? get3(dL_dimage, i) : Vec3f{};
    put3(dL_dmirrored, left_to_right(i, width), seen[i] * hadamard(tint, g));
    if (sees) put3(dL_dimage, i, seen[i] < 1 ? (1 - seen[i]) * g : Vec3f{});
  }
};

// What is left of a picture without a share of it that is mirrored, brought back to the whole: the
// other way round as PutMirror. Photos are clipped, so it may be too dark, and never below black.
GLINT_HD Vec3f without_share(Vec3f whole, float share, Vec3f mirrored) {
  const Vec3f rest = (1 / (1 - share)) * (whole - share * mirrored);
  return {max_of(rest.x, 0.0f), max_of(rest.y, 0.0f), max_of(rest.z, 0.0f)};
}
struct TakeOutMirror {
  int width;
  Vec3f tint;
  const float *seen, *mirrored;
  float* image;
  GLINT_HD void operator()(std::size_t i) const {
    if (seen[i] <= 0 || seen[i] >= 1) return;
    const Vec3f part = hadamard(tint, get3(mirrored, left_to_right(i, width)));
    put3(image, i, without_share(get3(image, i), seen[i], part));
  }
};
// In pixels that see a pane, what the interface mirrors there by its k_s.
struct TakeOutReflection {
  const float *seen, *specularity, *reflection;
  float* image;
  GLINT_HD void operator()(std::size_t i) const {
    if (seen[i] > 0 && specularity[i] < 1)
      put3(image, i, without_share(get3(image, i), specularity[i], get3(reflection, i)));
  }
};

// 1 where a pixel counts and sees no mirror. counted: null: all do.
struct CountOutsideMirror {
  const float *counted, *seen;
  float* out;
  GLINT_HD void operator()(std::size_t i) const {
    out[i] = seen[i] > 0 ? 0.0f : (counted == nullptr ? 1.0f : counted[i]);
  }
};
struct AddSeen {
  const float* seen;
  float* sum;  // 1 where one of them is
  GLINT_HD void operator()(std::size_t i) const {
    if (seen[i] > 0) sum[i] = 1;
  }
};

using PlaneMirrorsKernels = KernelList<
    SeeMirror,
    PutMirror,
    PutMirrorVjp,
    TakeOutMirror,
    TakeOutReflection,
    CountOutsideMirror,
    AddSeen>;

}  // namespace glint
