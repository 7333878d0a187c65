// SPDX-License-Identifier: MIT
// The way back through traced rays, second half: hits in the order of their surfels, and a warp a
// surfel that sums over them in registers; lanes take every 32nd. The order of all sums is fixed.
#pragma once

#include "glint/cuda/trace_backward_bodies.h"

namespace glint::gpu {

// Sums over hits that one surfel gets back, floats.
enum TraceSum {
  kTraceMean = 0,        // 3
  kTraceH0 = 3,          // 3
  kTraceH1 = 6,          // 3
  kTraceNormal = 9,      // 3
  kTraceHalfDepth = 12,  // 3
  kTraceOpacity = 15,
  kTraceWeight = 16,
  kTraceSh = 17,  // 3 a coefficient
};
template <int kDegree>
inline constexpr int kTraceSums = kTraceSh + 3 * sh_coefficients(kDegree);

// A surfel's hits among the sorted ones: [begin, end).
struct HitRun {
  std::uint32_t begin, end;
  GLINT_HD std::uint32_t size() const { return end - begin; }
};
// Runs longer than this are summed by many warps: of windows of as many sorted hits, of which one
// meets two long runs at most, one that begins before and one that ends behind it.
inline constexpr std::uint32_t kLongRun = 1024;

struct FindRuns {
  const std::uint32_t* keys;
  std::size_t num_slots;
  std::size_t count;
  HitRun* runs;  // [slots] zero

  GLINT_HD void operator()(std::size_t i) const {
    const std::uint32_t slot = keys[i];
    if (slot >= num_slots) return;
    if (i == 0 || keys[i - 1] != slot) runs[slot].begin = static_cast<std::uint32_t>(i);
    if (i + 1 == count || keys[i + 1] != slot) runs[slot].end = static_cast<std::uint32_t>(i + 1);
  }
};

// What sums over hits read.
struct SortedHits {
  const Disc* discs;
  DeviceTraceInput input;
  DeviceRays rays;
  TraceCutoffs cutoffs;
  DeviceTraceOutput dL_dout;  // images may be null
  const HitGradient* hits;
  const std::uint32_t* keys;   // sorted
  const std::uint32_t* order;  // into `hits`
  const HitRun* runs;
  std::uint32_t count;
};

template <int kDegree>
struct HitSums {
  static constexpr int kSums = kTraceSums<kDegree>;
  float v[kSums] = {};

  GLINT_HD void add(int at, Vec3f x) {
    v[at] += x.x;
    v[at + 1] += x.y;
    v[at + 2] += x.z;
  }
  GLINT_HD void add_hit(const SortedHits& from, const Disc& disc, std::uint32_t i) {
    const HitGradient hit = from.hits[from.order[i]];
    const Vec3f origin = from.rays.origin(hit.ray), direction = from.rays.direction(hit.ray);
    const RayLoss loss(from.dL_dout, hit.ray);
    const PlaneHit<float> plane = meet(disc, origin, direction);
    const SplatAlpha<float> alpha = alpha_of(disc, plane, from.cutoffs.max_rho);
    Vec3f dL_ddirection;  // the rays' own
    const DiscGradient g = disc_vjp(
        disc, plane, alpha, origin, direction, hit.dL_dalpha, hit.weight * loss.depth, dL_ddirection
    );
    add(kTraceMean, g.mean);
    add(kTraceH0, g.h0);
    add(kTraceH1, g.h1);
    add(kTraceNormal, (dot(disc.normal, direction) > 0 ? -hit.weight : hit.weight) * loss.normal);
    add(kTraceHalfDepth, (0.5f * plane.t) * g.mean);
    v[kTraceOpacity] += g.opacity;
    v[kTraceWeight] += hit.weight;
    add_color(hit, loss, direction);
  }

 private:
  GLINT_HD void add_color(const HitGradient& hit, const RayLoss& loss, Vec3f direction) {
    float basis[16];
    sh_basis(kDegree, normalize(direction), basis);
    Vec3f g;
    unrolled<3>([&](int c) {
      g[c] = (hit.clamped >> c & 1u) != 0 ? 0.0f : hit.weight * loss.color[c];
    });
    unrolled<sh_coefficients(kDegree)>([&](int k) { add(kTraceSh + 3 * k, basis[k] * g); });
  }
};

// Sums of a warp's lanes, over the lanes: [lane][sum]. Their number is odd or the row is padded,
// so that neither a row's nor a column's lanes wait for each other.
template <int kDegree>
struct LaneSums {
  static constexpr int kSums = kTraceSums<kDegree>;
  float v[kWarp][kSums | 1];

  // Of hits [begin, end) of one disc; `to`: kSums floats.
  template <class Block>
  GLINT_HD void sum(Block& block, const SortedHits& from, const Disc& disc, HitRun run, float* to) {
    const std::uint32_t lanes = run.size() < kWarp ? run.size() : kWarp;
    block.each([&](int lane) {
      const auto first = static_cast<std::uint32_t>(lane);
      if (first >= lanes) return;
      HitSums<kDegree> sums;
      for (std::uint32_t i = run.begin + first; i < run.end; i += kWarp)
        sums.add_hit(from, disc, i);
      unrolled<kSums>([&](int k) { v[lane][k] = sums.v[k]; });
    });
    block.each([&](int lane) {
      for (int k = lane; k < kSums; k += kWarp) {
        float total = 0;
        for (std::uint32_t i = 0; i < lanes; ++i) total += v[i][k];
        to[k] = total;
      }
    });
  }
};

// Sums of what a window of sorted hits has of long runs: that of its first hit and that of its
// last.
template <int kDegree>
struct SumWindows {
  static constexpr int kThreads = kWarp;
  using Shared = LaneSums<kDegree>;
  SortedHits from;
  float* sums;  // [windows][2][kTraceSums]

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    const std::uint32_t begin = static_cast<std::uint32_t>(block.index) * kLongRun;
    const std::uint32_t end = min(begin + kLongRun, from.count);
    float* to = sums + std::size_t{2} * static_cast<std::size_t>(block.index) * Shared::kSums;
    const std::uint32_t first = from.keys[begin], last = from.keys[end - 1];
    sum(block, shared, first, {begin, end}, to);
    if (last != first) sum(block, shared, last, {begin, end}, to + Shared::kSums);
  }

 private:
  GLINT_HD static std::uint32_t min(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
  GLINT_HD static std::uint32_t max(std::uint32_t a, std::uint32_t b) { return a > b ? a : b; }
  template <class Block>
  GLINT_HD void sum(Block& block, Shared& shared, std::uint32_t slot, HitRun window, float* to)
      const {
    if (slot >= from.input.count) return;
    const HitRun run = from.runs[slot];
    if (run.size() <= kLongRun) return;
    shared.sum(
        block, from, from.discs[slot], {max(run.begin, window.begin), min(run.end, window.end)}, to
    );
  }
};

// Shapes of TraceGradient.
struct DeviceTraceGradients {
  float *means, *scales, *rotations, *opacities, *sh_dc, *sh_rest, *visibility, *half_depths;
  float *origins, *directions;
};

// A surfel's sums, and from them back to its parameters.
template <int kDegree>
struct GatherSurfels {
  static constexpr int kThreads = kWarp, kSums = kTraceSums<kDegree>;
  struct Shared {
    LaneSums<kDegree> lanes;
    float sums[kSums];
  };
  SortedHits from;
  const float* windows;  // [windows][2][kTraceSums]
  DeviceTraceGradients out;

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    const auto slot = static_cast<std::size_t>(block.index);
    const HitRun run = from.runs[slot];
    const Disc& disc = from.discs[slot];
    if (run.size() <= kLongRun)
      shared.lanes.sum(block, from, disc, run, shared.sums);
    else
      block.each([&](int lane) {
        for (int k = lane; k < kSums; k += kWarp) shared.sums[k] = window_sum(run, k);
      });
    block.each([&](int lane) {
      if (lane == 0) put_geometry(disc.surfel, shared.sums);
      for (int k = lane; k < 48; k += kWarp)
        put_sh(disc.surfel, k, k < kSums - kTraceSh ? shared.sums[kTraceSh + k] : 0.0f);
    });
  }

 private:
  GLINT_HD float window_sum(HitRun run, int k) const {
    float sum = 0;
    for (std::uint32_t window = run.begin / kLongRun; window * kLongRun < run.end; ++window) {
      const bool begins_inside = run.begin > window * kLongRun;
      sum += windows[std::size_t{2 * window + begins_inside} * kSums + static_cast<unsigned>(k)];
    }
    return sum;
  }
  GLINT_HD void put_sh(std::size_t i, int k, float value) const {
    if (k < 3)
      out.sh_dc[3 * i + static_cast<std::size_t>(k)] = value;
    else
      out.sh_rest[45 * i + static_cast<std::size_t>(k - 3)] = value;
  }
  GLINT_HD void put_geometry(std::size_t i, const float* s) const {
    const DeviceTraceInput& input = from.input;
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
    unrolled<4>([&](int k) { out.rotations[4 * i + static_cast<std::size_t>(k)] = rotations[k]; });
    put3(out.means, i, at3(kTraceMean));
    put3(out.half_depths, i, at3(kTraceHalfDepth));
    out.opacities[i] = s[kTraceOpacity];
    out.visibility[i] = s[kTraceWeight];
  }
};

}  // namespace glint::gpu
