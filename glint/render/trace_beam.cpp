// SPDX-License-Identifier: MIT
#include "glint/render/trace_beam.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace glint {

namespace {

constexpr std::size_t kLanes = Float8::kLanes;
constexpr float kRounding = 4e-6f;  // of products of lengths: several times what the tests can lose
constexpr float kFurther = 1 + 1e-5f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// What all rays of a beam may meet of eight surfels.
struct BeamTest {
  Mask8 may_meet;
  Float8 nearest;   // lower bound of the distance of a hit
  Float8 distance;  // of the centre from the beam's origin
};

// zeta and det (intersect.h) of every ray of the beam lie around those of its centre: with
// m' - m = o - o' and d' - d bounded by the beam's radii,
//   |h (m' x d') - h (m x d)| <= |h| (|m| r_d + r_o),  |e3 d' - e3 d| <= |e3| r_d,
//   |m' e3 - m e3| <= |e3| r_o.
// A ray that meets the disc passes its centre within its radius, too.
GLINT_SIMD_INLINE BeamTest test(const Beam& beam, const EightSurfels& s) {
  const SurfelFields<Float8>& f = s.fields;
  const Vec3<Float8> m = f.mean - all_lanes(beam.origin), d = all_lanes(beam.direction);
  const Vec3<Float8> c = cross(m, d);
  const Float8 length0 = sqrt_of(length2(f.h0)), length1 = sqrt_of(length2(f.h1));
  const Float8 distance = sqrt_of(length2(m)), e3 = length0 * length1;
  const Float8 turn(beam.direction_radius + kRounding);
  const Float8 shift = fma_of(distance, Float8(kRounding), Float8(beam.origin_radius * kFurther));
  const Float8 spread = fma_of(distance, turn, shift);

  const Float8 u = max_of(abs_of(dot(f.h1, c)) - length1 * spread, Float8(0.0f));
  const Float8 v = max_of(abs_of(dot(f.h0, c)) - length0 * spread, Float8(0.0f));
  const Float8 facing = dot(s.e3, d), det = dot(m, s.e3);
  const Float8 most_facing = fma_of(e3, turn, abs_of(facing));
  const Float8 least_det = abs_of(det) - e3 * shift;
  const Float8 reach = sqrt_of(f.max_rho) * max_of(length0, length1) * Float8(kFurther);
  const Float8 pass = reach + spread, along = dot(m, d);

  const Mask8 counts = f.max_rho > Float8(0.0f);
  const Mask8 near_disc =
      fma_of(u, u, v * v) <= f.max_rho * Float8(kFurther) * (most_facing * most_facing);
  const Mask8 near_ball = length2(c) <= pass * pass * Float8(kFurther);
  const Mask8 behind_plane =
      (abs_of(facing) > e3 * turn) & (least_det > Float8(0.0f)) & (facing * det < Float8(0.0f));
  const Mask8 behind = (along + pass < Float8(0.0f)) | behind_plane;
  const Float8 to_plane = least_det / most_facing;
  const Float8 nearest = max_of(max_of(to_plane, along - pass), Float8(0.0f));
  return {counts & near_disc & near_ball & !behind, nearest * Float8(1 / kFurther), distance};
}

Vec3f ray_vector(const Rays& rays, int k, std::size_t i) {
  const float* p = (k == 0 ? rays.origins : rays.directions).data() + 3 * i;
  const Vec3f v{p[0], p[1], p[2]};
  return k == 0 ? v : normalize(v);
}

}  // namespace

RayBounds ray_bounds(const Rays& rays, std::span<const std::uint32_t> chosen) {
  RayBounds b;
  for (int k = 0; k < 2; ++k) {
    b.low[k] = b.high[k] = ray_vector(rays, k, chosen.front());
    for (const std::uint32_t i : chosen) {
      const Vec3f v = ray_vector(rays, k, i);
      for (int axis = 0; axis < 3; ++axis) {
        b.low[k][axis] = std::min(b.low[k][axis], v[axis]);
        b.high[k][axis] = std::max(b.high[k][axis], v[axis]);
      }
    }
  }
  return b;
}

Beam bounding_beam(
    const Rays& rays, std::span<const std::uint32_t> chosen, const RayBounds& bounds
) {
  Beam beam{0.5f * (bounds.low[0] + bounds.high[0]), 0.5f * (bounds.low[1] + bounds.high[1]), 0, 0};
  const float norm = length(beam.direction);
  beam.direction = norm > 0 ? (1 / norm) * beam.direction : Vec3f{0, 0, 1};
  float origin2 = 0, direction2 = 0;
  for (const std::uint32_t i : chosen) {
    origin2 = std::max(origin2, length2(ray_vector(rays, 0, i) - beam.origin));
    direction2 = std::max(direction2, length2(ray_vector(rays, 1, i) - beam.direction));
  }
  beam.origin_radius = std::sqrt(origin2);
  beam.direction_radius = std::sqrt(direction2);
  return beam;
}

std::size_t split_rays(
    const Rays& rays, const RayBounds& bounds, float distance, std::span<std::uint32_t> chosen
) {
  float widest = -1, middle = 0;
  int which = 0, along = 0;
  for (int k = 0; k < 2; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      const float low = bounds.low[k][axis], high = bounds.high[k][axis];
      const float width = (k == 0 ? 1 : distance) * (high - low);
      if (width <= widest) continue;
      widest = width, middle = 0.5f * (low + high), which = k, along = axis;
    }
  const auto second = std::partition(chosen.begin(), chosen.end(), [&](std::uint32_t i) {
    return ray_vector(rays, which, i)[along] < middle;
  });
  return static_cast<std::size_t>(second - chosen.begin());
}

bool fits_beam(Vec3f origin, Vec3f direction) {
  const float square = length2(direction);
  return square > 1e-20f && square < 1e20f && length2(origin) < 1e20f;
}

void BeamSurfels::reserve(std::size_t count) {
  const std::size_t needed = (count + 2 * kLanes) / kLanes * kLanes + kLanes;
  if (needed <= stride_) return;
  // An odd number of cache lines apart: columns of one surfel then fall into different sets.
  stride_ = (needed + 15) / 32 * 32 + 48;
  floats_ = std::make_unique_for_overwrite<float[]>(kColumns * stride_);
}

EightSurfels BeamSurfels::load(std::size_t group) const {
  const float* p = floats_.get() + kLanes * group;
  const auto at = [&](int c) { return Float8::load(p + static_cast<std::size_t>(c) * stride_); };
  const auto at3 = [&](int c) { return Vec3<Float8>{at(c), at(c + 1), at(c + 2)}; };
  return {
      {at3(0), at3(3), at3(6), at(9), at(10)},
      at3(kE3),
      reinterpret_cast<Mask8::Lanes>(at(kSurfel).lanes),
      reinterpret_cast<Mask8::Lanes>(at(kSlot).lanes)};
}

GLINT_SIMD_INLINE void BeamSurfels::append(const EightSurfels& s, Float8 nearest, unsigned lanes) {
  const Mask8::Lanes order = kPackTable.order(lanes);
  const SurfelFields<Float8>& f = s.fields;
  const Float8 columns[kColumns] = {
      f.mean.x,
      f.mean.y,
      f.mean.z,
      f.h0.x,
      f.h0.y,
      f.h0.z,
      f.h1.x,
      f.h1.y,
      f.h1.z,
      f.opacity,
      f.max_rho,
      s.e3.x,
      s.e3.y,
      s.e3.z,
      nearest,
      reinterpret_cast<Float8::Lanes>(s.surfels),
      reinterpret_cast<Float8::Lanes>(s.slots)};
  float* to = floats_.get() + count_;
  for (int c = 0; c < kColumns; ++c, to += stride_)
    Float8(__builtin_shuffle(columns[c].lanes, order)).store(to);
  count_ += static_cast<std::size_t>(std::popcount(lanes));
}

// Lanes behind the last surfel count nowhere.
void BeamSurfels::pad() {
  for (int c = 0; c < kColumns; ++c)
    Float8(c == kNearest ? kInfinity : 0.0f).store(column(c) + count_);
  Float8(-1.0f).store(column(kFields + 10) + count_);
}

template <class Source>
void BeamSurfels::cull_all(const Beam& beam, std::size_t groups, const Source& source) {
  reserve(kLanes * groups);
  count_ = 0;
  Float8 distances(0.0f);
  for (std::size_t i = 0; i < groups; ++i) {
    const EightSurfels s = source(i);
    const BeamTest result = test(beam, s);
    const unsigned lanes = lane_bits(result.may_meet);
    if (lanes == 0) continue;
    distances += keep(result.may_meet, result.distance);
    append(s, result.nearest, lanes);
  }
  pad();
  mean_distance_ = lane_sum(distances) / static_cast<float>(std::max<std::size_t>(count_, 1));
}

void BeamSurfels::cull(const Beam& beam, std::span<const SurfelCluster> from) {
  cull_all(beam, from.size(), [&](std::size_t i) { return from[i].load(i); });
}

void BeamSurfels::cull(const Beam& beam, const BeamSurfels& from) {
  cull_all(beam, (from.count_ + kLanes - 1) / kLanes, [&](std::size_t i) { return from.load(i); });
}

// By buckets of equal depth: groups need a bound in front of all that follow, no strict order.
void BeamSurfels::sort(const BeamSurfels& from) {
  constexpr std::size_t kBuckets = 128;
  reserve(from.count_);
  count_ = from.count_;
  const float* nearest = from.column(kNearest);
  const auto [low, high] = std::minmax_element(nearest, nearest + count_);
  const float first = count_ > 0 ? *low : 0.0f, width = count_ > 0 ? *high - first : 0.0f;
  const float scale = width > 0 ? (kBuckets - 1) / width : 0.0f;
  const auto bucket = [&](std::size_t i) {
    return static_cast<std::size_t>(std::min((nearest[i] - first) * scale, float{kBuckets - 1}));
  };
  std::array<std::uint32_t, kBuckets + 1> starts{};
  for (std::size_t i = 0; i < count_; ++i) ++starts[bucket(i) + 1];
  for (std::size_t b = 0; b < kBuckets; ++b) starts[b + 1] += starts[b];
  for (std::size_t i = 0; i < count_; ++i) {
    const std::size_t place = starts[bucket(i)]++;
    for (int c = 0; c < kColumns; ++c) column(c)[place] = from.column(c)[i];
  }
  pad();
  group_nearest_.resize((count_ + kLanes - 1) / kLanes);
  float bound = kInfinity;
  for (std::size_t group = group_nearest_.size(); group-- > 0;) {
    const float* p = column(kNearest) + kLanes * group;
    bound = std::min(bound, *std::min_element(p, p + kLanes));
    group_nearest_[group] = bound;
  }
}

void BeamSurfels::nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const {
  const Vec3<Float8> o = all_lanes(origin), d = all_lanes(direction);
  const float norm = length(direction) * kFurther;
  for (std::size_t group = 0; group < group_nearest_.size(); ++group) {
    if (group_nearest_[group] > hits.last_t() * norm) break;
    offer(load(group), o, d, hits);
  }
}

}  // namespace glint
