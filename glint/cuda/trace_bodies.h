// SPDX-License-Identifier: MIT
// Rays through surfels on the GPU: one thread a ray, the nearest hits of the tree kept in order
// (t, index) a few at a time, composited front to back. What a ray met is kept for the way back.
// Formulas: intersect.h, blend.h, spherical_harmonics.h; contract: glint/render/trace.h.
#pragma once

#include "glint/cuda/bvh_bodies.h"
#include "glint/render/intersect.h"
#include "glint/render/spherical_harmonics.h"

namespace glint::gpu {

// Hits strictly behind `after`, sorted.
struct HitKey {
  float t;
  std::uint32_t surfel;
  GLINT_HD bool before(const HitKey& other) const {
    return t < other.t || (t == other.t && surfel < other.surfel);
  }
};
struct HitList {
  static constexpr int kCapacity = 16;
  HitKey after, hits[kCapacity];
  int count;

  GLINT_HD float last_t() const { return count == kCapacity ? hits[kCapacity - 1].t : 1e30f; }
  GLINT_HD void insert(HitKey hit) {
    if (!after.before(hit)) return;
    if (count == kCapacity && !hit.before(hits[kCapacity - 1])) return;
    int place = count == kCapacity ? kCapacity - 1 : count;
    for (; place > 0 && hit.before(hits[place - 1]); --place) hits[place] = hits[place - 1];
    hits[place] = hit;
    if (count < kCapacity) ++count;
  }
};

struct Tree {
  const TreeNode* nodes;
  const std::uint32_t* order;
  const DiscSurfel* discs;
  std::uint32_t count;

  GLINT_HD bool is_leaf(std::uint32_t node) const { return node >= count - 1; }
};

GLINT_HD PlaneHit<float> meet(const DiscSurfel& d, Vec3f origin, Vec3f direction) {
  const RayPlane<float> plane =
      ray_plane(d.h0, d.h1, cross(d.h0, d.h1), d.mean - origin, direction);
  return intersect(plane.zeta, plane.det);
}

// Where a ray enters a box, behind 0; 2e30 where it does not, where that is behind `far`, or where
// it leaves before `near`. An empty box has its near sides behind its far ones.
GLINT_HD float entry(const Box& box, Vec3f origin, Vec3f inverse, float near, float far) {
  constexpr float kRounding = 1.00001f;
  float in = 0, out = 1e30f;
  for (int axis = 0; axis < 3; ++axis) {
    const bool forward = inverse[axis] >= 0;
    const float a = (box.low[axis] - origin[axis]) * inverse[axis];
    const float b = (box.high[axis] - origin[axis]) * inverse[axis];
    in = max_of(in, forward ? a : b);
    out = min_of(out, forward ? b : a);
  }
  out *= kRounding;
  return in <= out && out >= near && in <= far * kRounding ? in : 2e30f;
}

// What a ray costs, for those who ask (tests); kernels count nothing.
struct WalkCounts {
  static constexpr bool kCounts = true;
  std::uint32_t nodes = 0, discs = 0, hits = 0, searches = 0;
  GLINT_HD void node() { ++nodes; }
  GLINT_HD void disc() { ++discs; }
  GLINT_HD void hit() { ++hits; }
  GLINT_HD void search() { ++searches; }
};
struct NoCounts {
  static constexpr bool kCounts = false;
  GLINT_HD void node() {}
  GLINT_HD void disc() {}
  GLINT_HD void hit() {}
  GLINT_HD void search() {}
};

// The nearest hits behind list.after.
template <class Counts>
GLINT_HD void find_nearest(
    const Tree& tree, Vec3f origin, Vec3f direction, HitList& list, Counts& counts
) {
  constexpr int kStack = 64;  // levels: keys have 64 bits
  const auto safe = [](float v) { return abs_of(v) > 1e-20f ? 1 / v : (v < 0 ? -1e20f : 1e20f); };
  const Vec3f inverse{safe(direction.x), safe(direction.y), safe(direction.z)};
  std::uint32_t stack[kStack];
  int size = 0;
  stack[size++] = 0;
  list.count = 0;
  const auto enter = [&](const Box& box) {
    return entry(box, origin, inverse, list.after.t, list.last_t());
  };
  while (size > 0) {
    const std::uint32_t index = stack[--size];
    const TreeNode& node = tree.nodes[index];
    counts.node();
    if (enter(node.box) > 1e30f) continue;
    if (tree.is_leaf(index)) {
      counts.disc();
      const std::uint32_t surfel = tree.order[index - (tree.count - 1)];
      const DiscSurfel& disc = tree.discs[surfel];
      const PlaneHit<float> hit = meet(disc, origin, direction);
      if (squared_radius(hit) <= disc.max_rho && hit.t < 1e30f) list.insert({hit.t, surfel});
      continue;
    }
    const float left = enter(tree.nodes[node.left].box);
    const float right = enter(tree.nodes[node.right].box);
    // The farther child first onto the stack.
    const bool left_first = left <= right;
    const float near = left_first ? left : right, far = left_first ? right : left;
    if (far < 1e30f) stack[size++] = left_first ? node.right : node.left;
    if (near < 1e30f) stack[size++] = left_first ? node.left : node.right;
  }
}

// Colour of a surfel along a ray, before sh_color().
GLINT_HD Vec3f sh_sum(const DeviceTraceInput& input, const float basis[16], std::uint32_t surfel) {
  const std::size_t i = surfel;
  const float *dc = input.sh_dc + 3 * i, *rest = input.sh_rest + 45 * i;
  Vec3f sum = basis[0] * Vec3f{dc[0], dc[1], dc[2]};
  for (int k = 1; k < sh_coefficients(input.sh_degree); ++k, rest += 3)
    sum += basis[k] * Vec3f{rest[0], rest[1], rest[2]};
  return sum;
}
GLINT_HD Vec3f colors_of(Vec3f sum) { return {sh_color(sum.x), sh_color(sum.y), sh_color(sum.z)}; }

struct DeviceRays {
  const float *origins, *directions;  // [rays][3]
  GLINT_HD Vec3f origin(std::size_t i) const { return at(origins, i); }
  GLINT_HD Vec3f direction(std::size_t i) const { return at(directions, i); }
  GLINT_HD static Vec3f at(const float* p, std::size_t i) {
    return {p[3 * i], p[3 * i + 1], p[3 * i + 2]};
  }
};
// Neither without direction nor not finite.
GLINT_HD bool is_ray(Vec3f origin, Vec3f direction) {
  const float d2 = length2(direction);
  return d2 > 0 && d2 + length2(origin) < 1e30f;
}

struct DeviceTraceOutput {
  float *color, *alpha, *depth_sum, *normal;
};
// Hits of ray i at [i * max_hits, i * max_hits + counts[i]).
struct DeviceHits {
  std::uint32_t *counts, *surfels;
};

template <class Counts = NoCounts>
struct ForwardRays {
  Tree tree;
  DeviceTraceInput input;
  DeviceRays rays;
  TraceCutoffs cutoffs;
  DeviceTraceOutput out;
  DeviceHits saved;
  Counts* counts = nullptr;  // [rays], where they are asked for

  struct Sums {
    Vec3f color{}, normal{};
    float depth = 0, transmittance = 1;
  };

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f origin = rays.origin(i), direction = rays.direction(i);
    Sums sums;
    Counts count;
    int hits = 0;
    if (is_ray(origin, direction) && input.count > 0)
      hits = trace(origin, direction, saved.surfels + i * max_hits(), sums, count);
    if constexpr (Counts::kCounts) counts[i] = count;
    saved.counts[i] = static_cast<std::uint32_t>(hits);
    put3(out.color, i, sums.color);
    put3(out.normal, i, sums.normal);
    out.depth_sum[i] = sums.depth;
    out.alpha[i] = 1 - abs_of(sums.transmittance);
  }
  GLINT_HD std::size_t max_hits() const { return static_cast<std::size_t>(cutoffs.max_hits); }

 private:
  GLINT_HD int trace(Vec3f origin, Vec3f direction, std::uint32_t* kept, Sums& sums, Counts& counts)
      const {
    float basis[16];
    sh_basis(input.sh_degree, normalize(direction), basis);
    HitList list;
    list.after = {max_of(cutoffs.near, 0.0f), ~0u};
    int count = 0;
    do {
      counts.search();
      find_nearest(tree, origin, direction, list, counts);
      for (int k = 0; k < list.count && count < cutoffs.max_hits; ++k) {
        const int counted = composite(list.hits[k], origin, direction, basis, sums);
        if (counted < 0) return count;
        if (counted == 0) continue;
        counts.hit();
        kept[count++] = list.hits[k].surfel;
      }
      if (list.count > 0) list.after = list.hits[list.count - 1];
    } while (list.count == HitList::kCapacity && count < cutoffs.max_hits);
    return count;
  }
  // 1: the hit counts, 0: it does not, -1: it stops the ray.
  GLINT_HD int composite(
      const HitKey& key, Vec3f origin, Vec3f direction, const float basis[16], Sums& sums
  ) const {
    const DiscSurfel& disc = tree.discs[key.surfel];
    const float rho = squared_radius(meet(disc, origin, direction));
    const float alpha = splat_alpha(disc.opacity, min_of(rho, cutoffs.max_rho)).alpha;
    if (alpha < cutoffs.min_alpha) return 0;
    const BlendStep<float> step = blend_step(sums.transmittance, alpha, cutoffs.min_transmittance);
    sums.transmittance = step.transmittance;
    if (step.transmittance < 0) return -1;
    sums.color += step.weight * colors_of(sh_sum(input, basis, key.surfel));
    sums.normal += (dot(disc.normal, direction) > 0 ? -step.weight : step.weight) * disc.normal;
    sums.depth += step.weight * key.t;
    return 1;
  }
};

// Sums over hits that one surfel gets back, floats.
enum TraceSum {
  kTraceMean = 0,        // 3
  kTraceH0 = 3,          // 3
  kTraceH1 = 6,          // 3
  kTraceNormal = 9,      // 3
  kTraceHalfDepth = 12,  // 3
  kTraceOpacity = 15,
  kTraceWeight = 16,
  kTraceShDc = 17,    // 3
  kTraceShRest = 20,  // 45
  kTraceSums = 68
};
GLINT_HD void add_atomic(float* p, float value) {
#if defined(__CUDA_ARCH__)
  atomicAdd(p, value);
#else
  *p += value;
#endif
}
GLINT_HD void add_atomic(float* p, Vec3f v) {
  add_atomic(p, v.x);
  add_atomic(p + 1, v.y);
  add_atomic(p + 2, v.z);
}

struct BackwardRays {
  const DiscSurfel* discs;
  DeviceTraceInput input;
  DeviceRays rays;
  TraceCutoffs cutoffs;
  DeviceTraceOutput out, dL_dout;  // images of dL_dout may be null
  DeviceHits saved;
  float* sums;                          // [N][kTraceSums]
  float *dL_dorigins, *dL_ddirections;  // [rays][3]

  struct State {
    Vec3f color, normal;
    float alpha, depth, remaining, transmittance = 1;
    Vec3f dL_dorigin{}, dL_ddirection{};
    float basis[16], dL_dbasis[16] = {};
  };

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f origin = rays.origin(i), direction = rays.direction(i);
    State state;
    start(i, state);
    const std::uint32_t count = saved.counts[i];
    if (count > 0) {
      const float norm = length(direction);
      const Vec3f unit = (1 / norm) * direction;
      sh_basis(input.sh_degree, unit, state.basis);
      const std::uint32_t* hits = saved.surfels + i * static_cast<std::size_t>(cutoffs.max_hits);
      for (std::uint32_t k = 0; k < count; ++k) hit(hits[k], origin, direction, state);
      Vec3f dL_dunit{};
      sh_basis_vjp(input.sh_degree, unit, state.dL_dbasis, dL_dunit);
      state.dL_ddirection += normalize_vjp(unit, norm, dL_dunit);
    }
    put3(dL_dorigins, i, state.dL_dorigin);
    put3(dL_ddirections, i, state.dL_ddirection);
  }

 private:
  GLINT_HD static Vec3f at3(const float* p, std::size_t i) {
    return p == nullptr ? Vec3f{} : Vec3f{p[3 * i], p[3 * i + 1], p[3 * i + 2]};
  }
  GLINT_HD static float at(const float* p, std::size_t i) { return p == nullptr ? 0.0f : p[i]; }
  GLINT_HD void start(std::size_t i, State& s) const {
    s.color = at3(dL_dout.color, i);
    s.normal = at3(dL_dout.normal, i);
    s.alpha = at(dL_dout.alpha, i);
    s.depth = at(dL_dout.depth_sum, i);
    s.remaining = dot(s.color, at3(out.color, i)) + dot(s.normal, at3(out.normal, i)) +
                  s.alpha * out.alpha[i] + s.depth * out.depth_sum[i];
  }
  // Back through one hit, front to back.
  GLINT_HD void hit(std::uint32_t surfel, Vec3f origin, Vec3f direction, State& s) const {
    const DiscSurfel& disc = discs[surfel];
    const PlaneHit<float> plane = meet(disc, origin, direction);
    const SplatAlpha<float> alpha =
        splat_alpha(disc.opacity, min_of(squared_radius(plane), cutoffs.max_rho));
    const BlendStep<float> step =
        blend_step(s.transmittance, alpha.alpha, cutoffs.min_transmittance);
    const Vec3f sum = sh_sum(input, s.basis, surfel);
    const bool away = dot(disc.normal, direction) > 0;
    const Vec3f normal = away ? -disc.normal : disc.normal;
    const float value =
        dot(s.color, colors_of(sum)) + dot(s.normal, normal) + s.depth * plane.t + s.alpha;
    s.remaining -= step.weight * value;
    const float dL_dalpha = blend_alpha_vjp(s.transmittance, alpha.alpha, value, s.remaining);
    s.transmittance = step.transmittance;
    float* to = sums + static_cast<std::size_t>(surfel) * kTraceSums;
    geometry_vjp(disc, plane, alpha, origin, direction, dL_dalpha, step.weight, to, s);
    add_atomic(to + kTraceNormal, (away ? -step.weight : step.weight) * s.normal);
    add_atomic(to + kTraceWeight, step.weight);
    color_vjp(surfel, sum, step.weight, to, s);
  }
  GLINT_HD void geometry_vjp(
      const DiscSurfel& disc,
      const PlaneHit<float>& plane,
      const SplatAlpha<float>& alpha,
      Vec3f origin,
      Vec3f direction,
      float dL_dalpha,
      float weight,
      float* to,
      State& s
  ) const {
    float dL_dopacity = 0, dL_drho = 0;
    splat_alpha_vjp(disc.opacity, alpha, dL_dalpha, dL_dopacity, dL_drho);
    RayPlane<float> g{};
    intersect_vjp(
        plane, 2 * dL_drho * plane.u, 2 * dL_drho * plane.v, weight * s.depth, g.zeta, g.det
    );
    Vec3f dL_dh0{}, dL_dh1{}, dL_dm{};
    ray_plane_vjp(
        disc.h0,
        disc.h1,
        cross(disc.h0, disc.h1),
        disc.mean - origin,
        direction,
        g,
        dL_dh0,
        dL_dh1,
        dL_dm,
        s.dL_ddirection
    );
    s.dL_dorigin += -dL_dm;
    add_atomic(to + kTraceMean, dL_dm);
    add_atomic(to + kTraceH0, dL_dh0);
    add_atomic(to + kTraceH1, dL_dh1);
    add_atomic(to + kTraceHalfDepth, (0.5f * plane.t) * dL_dm);
    add_atomic(to + kTraceOpacity, dL_dopacity);
  }
  GLINT_HD void color_vjp(std::uint32_t surfel, Vec3f sum, float weight, float* to, State& s)
      const {
    const Vec3f g{
        sh_color_vjp(sum.x, weight * s.color.x),
        sh_color_vjp(sum.y, weight * s.color.y),
        sh_color_vjp(sum.z, weight * s.color.z)};
    add_atomic(to + kTraceShDc, s.basis[0] * g);
    const float* rest = input.sh_rest + 45 * static_cast<std::size_t>(surfel);
    for (int k = 1; k < sh_coefficients(input.sh_degree); ++k, rest += 3) {
      add_atomic(to + kTraceShRest + 3 * (k - 1), s.basis[k] * g);
      s.dL_dbasis[k] += dot(g, Vec3f{rest[0], rest[1], rest[2]});
    }
  }
};

// Shapes of TraceGradient.
struct DeviceTraceGradients {
  float *means, *scales, *rotations, *opacities, *sh_dc, *sh_rest, *visibility, *half_depths;
  float *origins, *directions;
};

// From the sums back to a surfel's parameters.
struct DiscVjp {
  DeviceTraceInput input;
  const float* sums;  // [N][kTraceSums]
  DeviceTraceGradients out;

  GLINT_HD void operator()(std::size_t i) const {
    const float* s = sums + i * kTraceSums;
    const auto at3 = [&](int k) { return Vec3f{s[k], s[k + 1], s[k + 2]}; };
    const float* q = input.rotations + 4 * i;
    const Vec4f rotation{q[0], q[1], q[2], q[3]};
    const Mat3f r = rotation_matrix(rotation);
    const float su = input.scales[2 * i], sv = input.scales[2 * i + 1];
    out.scales[2 * i] = dot(at3(kTraceH0), column(r, 0));
    out.scales[2 * i + 1] = dot(at3(kTraceH1), column(r, 1));
    Vec4f g{};
    rotation_matrix_vjp(
        rotation, transpose(Mat3f{{su * at3(kTraceH0), sv * at3(kTraceH1), at3(kTraceNormal)}}), g
    );
    const float rotations[4] = {g.w, g.x, g.y, g.z};
    for (std::size_t k = 0; k < 4; ++k) out.rotations[4 * i + k] = rotations[k];
    put3(out.means, i, at3(kTraceMean));
    put3(out.half_depths, i, at3(kTraceHalfDepth));
    put3(out.sh_dc, i, at3(kTraceShDc));
    for (std::size_t k = 0; k < 45; ++k) out.sh_rest[45 * i + k] = s[kTraceShRest + k];
    out.opacities[i] = s[kTraceOpacity];
    out.visibility[i] = s[kTraceWeight];
  }
};

}  // namespace glint::gpu
