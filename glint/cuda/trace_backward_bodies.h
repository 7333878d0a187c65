// SPDX-License-Identifier: MIT
// The way back through traced rays, first half: each ray goes through its hits once more, in order,
// sums its own gradient and leaves for each hit what the surfel's will be made of
// (trace_gather_bodies.h). No sum is shared among threads.
#pragma once

#include "glint/core/unrolled.h"
#include "glint/cuda/trace_bodies.h"

namespace glint::gpu {

// Of a hit: all that does not follow from its surfel and ray.
struct alignas(16) HitGradient {
  std::uint32_t ray;
  float weight, dL_dalpha;
  std::uint32_t clamped;  // bit c: the colour's channel c is, and has no gradient
};
// Hits of all rays behind each other, those of a place at first[place]; what lies beyond the
// capacity is dropped, the same hits each time.
struct HitGradients {
  const std::uint32_t* first;  // [places + 1]
  std::uint32_t capacity;
  HitGradient* hits;     // [capacity]
  std::uint32_t* keys;   // the hits' slots
  std::uint32_t* order;  // their places in `hits`
};

// Gradients of a ray's outputs.
struct RayLoss {
  Vec3f color, normal;
  float alpha, depth;

  GLINT_HD RayLoss(const DeviceTraceOutput& dL_dout, std::size_t i)
      : color(at3(dL_dout.color, i)),
        normal(at3(dL_dout.normal, i)),
        alpha(at(dL_dout.alpha, i)),
        depth(at(dL_dout.depth_sum, i)) {}

 private:
  GLINT_HD static Vec3f at3(const float* p, std::size_t i) {
    return p == nullptr ? Vec3f{} : DeviceRays::at(p, i);
  }
  GLINT_HD static float at(const float* p, std::size_t i) { return p == nullptr ? 0.0f : p[i]; }
};

struct DiscGradient {
  Vec3f mean{}, h0{}, h1{};
  float opacity = 0;
};
// Adds to dL_ddirection.
GLINT_HD DiscGradient disc_vjp(
    const Disc& disc,
    const PlaneHit<float>& hit,
    const SplatAlpha<float>& alpha,
    Vec3f origin,
    Vec3f direction,
    float dL_dalpha,
    float dL_dt,
    Vec3f& dL_ddirection
) {
  DiscGradient g;
  float dL_drho = 0;
  splat_alpha_vjp(disc.opacity, alpha, dL_dalpha, g.opacity, dL_drho);
  RayPlane<float> dL_dplane{};
  intersect_vjp(
      hit, 2 * dL_drho * hit.u, 2 * dL_drho * hit.v, dL_dt, dL_dplane.zeta, dL_dplane.det
  );
  ray_plane_vjp(
      disc.h0,
      disc.h1,
      cross(disc.h0, disc.h1),
      disc.mean - origin,
      direction,
      dL_dplane,
      g.h0,
      g.h1,
      g.mean,
      dL_ddirection
  );
  return g;
}

template <int kDegree>
struct BackwardRays {
  const Disc* discs;
  DeviceTraceInput input;
  DeviceRays rays;
  TraceCutoffs cutoffs;
  DeviceTraceOutput out, dL_dout;  // images of dL_dout may be null
  DeviceHits saved;
  HitGradients gradients;
  float *dL_dorigins, *dL_ddirections;  // [rays][3]

  struct State {
    RayLoss loss;
    float remaining, transmittance = 1;
    Vec3f dL_dorigin{}, dL_ddirection{};
    float basis[16], dL_dbasis[16] = {};
  };

  GLINT_HD void operator()(std::size_t place) const {
    const std::size_t i = rays.ray(place);
    if (i >= rays.count) return;
    State state{.loss = RayLoss(dL_dout, i)};
    const auto count = static_cast<int>(saved.counts[place]);
    if (count > 0) hits(place, i, count, state);
    put3(dL_dorigins, i, state.dL_dorigin);
    put3(dL_ddirections, i, state.dL_ddirection);
  }

 private:
  GLINT_HD void hits(std::size_t place, std::size_t i, int count, State& s) const {
    const Vec3f origin = rays.origin(i), direction = rays.direction(i);
    const float norm = length(direction);
    const Vec3f unit = (1 / norm) * direction;
    sh_basis(kDegree, unit, s.basis);
    s.remaining = dot(s.loss.color, DeviceRays::at(out.color, i)) +
                  dot(s.loss.normal, DeviceRays::at(out.normal, i)) + s.loss.alpha * out.alpha[i] +
                  s.loss.depth * out.depth_sum[i];
    const std::uint32_t first = gradients.first[place];
    for (int k = 0; k < count; ++k) {
      const std::uint32_t slot = saved.slot(k, place), at = first + static_cast<std::uint32_t>(k);
      HitGradient g = hit(discs[slot], origin, direction, s);
      if (at >= gradients.capacity) continue;
      g.ray = static_cast<std::uint32_t>(i);
      gradients.hits[at] = g;
      gradients.keys[at] = slot;
      gradients.order[at] = at;
    }
    Vec3f dL_dunit{};
    sh_basis_vjp(kDegree, unit, s.dL_dbasis, dL_dunit);
    s.dL_ddirection += normalize_vjp(unit, norm, dL_dunit);
  }
  // Back through one hit, front to back.
  GLINT_HD HitGradient hit(const Disc& disc, Vec3f origin, Vec3f direction, State& s) const {
    const PlaneHit<float> plane = meet(disc, origin, direction);
    const SplatAlpha<float> alpha = alpha_of(disc, plane, cutoffs.max_rho);
    const BlendStep<float> step =
        blend_step(s.transmittance, alpha.alpha, cutoffs.min_transmittance);
    if (step.transmittance < 0) return {};  // rounded to the other side than when it was found
    const Vec3f sum = sh_sum<kDegree>(input, s.basis, disc.surfel);
    const Vec3f normal = dot(disc.normal, direction) > 0 ? -disc.normal : disc.normal;
    const float value = dot(s.loss.color, colors_of(sum)) + dot(s.loss.normal, normal) +
                        s.loss.depth * plane.t + s.loss.alpha;
    s.remaining -= step.weight * value;
    const float dL_dalpha = blend_alpha_vjp(s.transmittance, alpha.alpha, value, s.remaining);
    s.transmittance = step.transmittance;
    const DiscGradient g = disc_vjp(
        disc,
        plane,
        alpha,
        origin,
        direction,
        dL_dalpha,
        step.weight * s.loss.depth,
        s.dL_ddirection
    );
    s.dL_dorigin += -g.mean;
    const std::uint32_t clamped = color_vjp(disc.surfel, sum, step.weight, s);
    return {0, step.weight, dL_dalpha, clamped};
  }
  // Adds to dL_dbasis; which channels are clamped.
  GLINT_HD std::uint32_t color_vjp(std::uint32_t surfel, Vec3f sum, float weight, State& s) const {
    Vec3f g;
    std::uint32_t clamped = 0;
    unrolled<3>([&](int c) {
      g[c] = sh_color_vjp(sum[c], weight * s.loss.color[c]);
      if (sh_color_vjp(sum[c], 1.0f) == 0) clamped |= 1u << c;
    });
    const float* rest = input.sh_rest + 45 * static_cast<std::size_t>(surfel);
    unrolled<sh_coefficients(kDegree) - 1>([&](int k) {
      s.dL_dbasis[k + 1] += dot(g, Vec3f{rest[3 * k], rest[3 * k + 1], rest[3 * k + 2]});
    });
    return clamped;
  }
};

struct CopyWord {
  const std::uint32_t* from;
  std::uint32_t* to;
  GLINT_HD void operator()(std::size_t) const { *to = *from; }
};
// Behind the hits that there are, keys that sort last, and places that nobody reads.
struct PadKeys {
  const std::uint32_t* num_hits;
  std::uint32_t last;
  std::uint32_t *keys, *order;
  std::uint32_t* too_many;  // set where hits were dropped
  std::uint32_t capacity;

  GLINT_HD void operator()(std::size_t i) const {
    if (i >= *num_hits) keys[i] = last, order[i] = 0;
    if (i == 0 && *num_hits > capacity) *too_many = 1;
  }
};

}  // namespace glint::gpu
