// SPDX-License-Identifier: MIT
// Rays through surfels on the GPU, forward: their hits are found (trace_walk.h) and kept, then
// composited front to back. Formulas: intersect.h, blend.h, spherical_harmonics.h; contract:
// glint/render/trace.h.
#pragma once

#include "glint/core/unrolled.h"
#include "glint/cuda/trace_walk.h"
#include "glint/render/spherical_harmonics.h"

namespace glint::gpu {

// Rays are an image, or a list of them (width 0). Threads take them in places: 32 in a row, a warp,
// are 8 x 4 neighbours.
struct DeviceRays {
  const float *origins, *directions;  // [rays][3]
  std::size_t count;
  std::size_t width = 0;

  GLINT_HD Vec3f origin(std::size_t i) const { return at(origins, i); }
  GLINT_HD Vec3f direction(std::size_t i) const { return at(directions, i); }
  GLINT_HD static Vec3f at(const float* p, std::size_t i) {
    return {p[3 * i], p[3 * i + 1], p[3 * i + 2]};
  }
  // Whole warps.
  GLINT_HD std::size_t places() const {
    if (width == 0) return (count + kWarp - 1) / kWarp * kWarp;
    return tiles_x() * ((count / width + kTileHeight - 1) / kTileHeight) * kWarp;
  }
  // Of a place; `count` or more: it has none.
  GLINT_HD std::size_t ray(std::size_t place) const {
    if (width == 0) return place;
    const std::size_t tile = place / kWarp, lane = place % kWarp;
    const std::size_t x = tile % tiles_x() * kTileWidth + lane % kTileWidth;
    const std::size_t y = tile / tiles_x() * kTileHeight + lane / kTileWidth;
    return x < width ? y * width + x : count;
  }

 private:
  static constexpr std::size_t kTileWidth = 8, kTileHeight = 4;
  GLINT_HD std::size_t tiles_x() const { return (width + kTileWidth - 1) / kTileWidth; }
};
// Neither without direction nor not finite.
GLINT_HD bool is_ray(Vec3f origin, Vec3f direction) {
  const float d2 = length2(direction);
  return d2 > 0 && d2 + length2(origin) < 1e30f;
}

struct DeviceTraceOutput {
  float *color, *alpha, *depth_sum, *normal;
};
// Slots of hit k of all places lie together, so that a warp's do.
struct DeviceHits {
  std::uint32_t *counts, *slots;  // [places], [rows][places]
  std::size_t places;
  int rows;

  GLINT_HD std::uint32_t& slot(int k, std::size_t place) const {
    return slots[static_cast<std::size_t>(k) * places + place];
  }
};

// kHits: that a search finds at once.
template <int kHits, class Counts>
struct FindHits {
  static constexpr int kThreads = 128;
  using Shared = WalkStack<kThreads>;
  Tree tree;
  std::size_t num_surfels;
  DeviceRays rays;
  TraceCutoffs cutoffs;
  DeviceHits saved;
  std::uint32_t* too_many;   // set where a ray has more hits than there are rows
  Counts* counts = nullptr;  // [rays], where they are asked for

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& stack) const {
    block.each([&](int thread) {
      const std::size_t place =
          static_cast<std::size_t>(block.index) * kThreads + static_cast<std::size_t>(thread);
      if (place < saved.places) find(place, stack, thread);
    });
  }

 private:
  GLINT_HD void find(std::size_t place, Shared& stack, int thread) const {
    const std::size_t i = rays.ray(place);
    Counts count;
    int hits = 0;
    if (i < rays.count && num_surfels > 0) {
      const Vec3f origin = rays.origin(i), direction = rays.direction(i);
      if (is_ray(origin, direction)) {
        const WalkedRay ray(origin, direction);
        TreeWalk<NearestList<kHits>, Shared, Counts> walk(tree, ray, stack, thread, count);
        hits = keep(walk, ray, place, count);
      }
      if constexpr (Counts::kCounts) counts[i] = count;
    }
    saved.counts[place] = static_cast<std::uint32_t>(hits);
  }
  // Those that count, up to where the ray stops.
  template <class Walk>
  GLINT_HD int keep(Walk& walk, const WalkedRay& ray, std::size_t place, Counts& counts) const {
    NearestList<kHits> list(cutoffs.near);
    float transmittance = 1;
    int hits = 0;
    for (bool more = cutoffs.max_hits > 0; more;) {
      list.start();
      walk.nearest(list);
      more = list.give([&](std::uint32_t surfel) {
        const std::uint32_t slot = tree.slot_of[surfel];
        const Disc& disc = tree.discs[slot];
        const PlaneHit<float> hit = meet(disc, ray.origin, ray.direction);
        const float alpha = alpha_of(disc, hit, cutoffs.max_rho).alpha;
        if (alpha < cutoffs.min_alpha) return true;
        transmittance = blend_step(transmittance, alpha, cutoffs.min_transmittance).transmittance;
        if (transmittance < 0) return false;
        if (hits == saved.rows) {
          *too_many = 1;
          return false;
        }
        counts.hit();
        saved.slot(hits++, place) = slot;
        return hits < cutoffs.max_hits;
      });
    }
    return hits;
  }
};

// Colour of a surfel along a ray, before sh_color().
template <int kDegree>
GLINT_HD Vec3f sh_sum(const DeviceTraceInput& input, const float basis[16], std::uint32_t surfel) {
  const std::size_t i = surfel;
  const float *dc = input.sh_dc + 3 * i, *rest = input.sh_rest + 45 * i;
  Vec3f sum = basis[0] * Vec3f{dc[0], dc[1], dc[2]};
  unrolled<sh_coefficients(kDegree) - 1>([&](int k) {
    sum += basis[k + 1] * Vec3f{rest[3 * k], rest[3 * k + 1], rest[3 * k + 2]};
  });
  return sum;
}
GLINT_HD Vec3f colors_of(Vec3f sum) { return {sh_color(sum.x), sh_color(sum.y), sh_color(sum.z)}; }

// f.operator()<degree>().
template <class F>
void with_sh_degree(int degree, F&& f) {
  if (degree <= 0) return f.template operator()<0>();
  if (degree == 1) return f.template operator()<1>();
  if (degree == 2) return f.template operator()<2>();
  f.template operator()<3>();
}

template <int kDegree>
struct CompositeRays {
  const Disc* discs;
  DeviceTraceInput input;
  DeviceRays rays;
  TraceCutoffs cutoffs;
  DeviceHits saved;
  DeviceTraceOutput out;

  GLINT_HD void operator()(std::size_t place) const {
    const std::size_t i = rays.ray(place);
    if (i >= rays.count) return;
    const Vec3f origin = rays.origin(i), direction = rays.direction(i);
    const auto count = static_cast<int>(saved.counts[place]);
    float basis[16];
    sh_basis(kDegree, normalize(direction), basis);
    Vec3f color{}, normal{};
    float depth = 0, transmittance = 1;
    for (int k = 0; k < count; ++k) {
      const Disc& disc = discs[saved.slot(k, place)];
      const PlaneHit<float> hit = meet(disc, origin, direction);
      const float alpha = alpha_of(disc, hit, cutoffs.max_rho).alpha;
      const BlendStep<float> step = blend_step(transmittance, alpha, cutoffs.min_transmittance);
      transmittance = step.transmittance;
      color += step.weight * colors_of(sh_sum<kDegree>(input, basis, disc.surfel));
      normal += (dot(disc.normal, direction) > 0 ? -step.weight : step.weight) * disc.normal;
      depth += step.weight * hit.t;
    }
    put3(out.color, i, color);
    put3(out.normal, i, normal);
    out.depth_sum[i] = depth;
    out.alpha[i] = 1 - abs_of(transmittance);
  }
};

}  // namespace glint::gpu
