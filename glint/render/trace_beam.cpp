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
// A ray that meets the disc passes its centre within its radius, too. The margins for rounding
// cover that of the ray's own test.
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

float smallest(const float* eight) { return *std::min_element(eight, eight + kLanes); }

Vec3f ray_vector(const Rays& rays, int k, std::size_t i) {
  return k == 0 ? get3(rays.origins.data(), i) : normalize(get3(rays.directions.data(), i));
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

// ---- lists of surfels
// ---------------------------------------------------------------------------

void BeamSurfels::start(std::size_t most) {
  const std::size_t size = most + kLanes;  // whole vectors are appended
  if (slots_.size() < size) {
    slots_.resize(size);
    nearest_.resize(size);
  }
  count_ = 0;
}

GLINT_SIMD_INLINE void BeamSurfels::append(Mask8::Lanes slots, Float8 nearest, unsigned lanes) {
  const Mask8::Lanes order = kPackTable.order(lanes);
  store_integers(__builtin_shuffle(slots, order), &slots_[count_]);
  Float8(__builtin_shuffle(nearest.lanes, order)).store(&nearest_[count_]);
  count_ += static_cast<std::size_t>(std::popcount(lanes));
}

// Fills the last group with the surfel of slot 0, which load() lets count nowhere.
void BeamSurfels::pad() {
  store_integers(Mask8::Lanes{}, &slots_[count_]);
  Float8(kInfinity).store(&nearest_[count_]);
}

GLINT_SIMD_INLINE EightSurfels
BeamSurfels::load(std::size_t group, const std::vector<TracedSurfel>& surfels) const {
  const std::uint32_t* slots = &slots_[kLanes * group];
  const float* rows[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) rows[i] = surfels[slots[i]].floats();
  RowLanes c;
  load_columns(rows, c);
  EightSurfels s{
      surfel_lanes(c).fields,
      {},
      reinterpret_cast<Mask8::Lanes>(c[14].lanes),
      load_integers(slots)};
  s.e3 = cross(s.fields.h0, s.fields.h1);
  const auto left = static_cast<float>(count_ - kLanes * group);
  s.fields.max_rho = select(lane_indices<Float8>() < Float8(left), s.fields.max_rho, Float8(-1.0f));
  return s;
}

template <class Source>
void BeamSurfels::cull_all(const Beam& beam, std::size_t groups, const Source& source) {
  start(kLanes * groups);
  Float8 distances(0.0f);
  for (std::size_t i = 0; i < groups; ++i) {
    const EightSurfels s = source(i);
    const BeamTest result = test(beam, s);
    distances += keep(result.may_meet, result.distance);
    append(s.slots, result.nearest, lane_bits(result.may_meet));
  }
  pad();
  mean_distance_ = lane_sum(distances) / static_cast<float>(std::max<std::size_t>(count_, 1));
}

void BeamSurfels::cull(const Beam& beam, std::span<const SurfelCluster> clusters) {
  cull_all(beam, clusters.size(), [&](std::size_t i) { return clusters[i].load(i); });
}

void BeamSurfels::cull(
    const Beam& beam, const BeamSurfels& from, const std::vector<TracedSurfel>& surfels
) {
  cull_all(beam, from.groups(), [&](std::size_t i) { return from.load(i, surfels); });
}

// By buckets of equal depth: groups need a bound in front of all that follow, no strict order.
void BeamSurfels::sort(const BeamSurfels& from) {
  constexpr std::size_t kBuckets = 128;
  start(from.count_);
  mean_distance_ = from.mean_distance_;
  float first = kInfinity, last = 0;
  for (std::size_t i = 0; i < from.count_; ++i) {
    first = std::min(first, from.nearest_[i]);
    last = std::max(last, from.nearest_[i]);
  }
  const float scale = last > first ? (kBuckets - 1) / (last - first) : 0.0f;
  const auto bucket = [&](std::size_t i) {
    return static_cast<std::size_t>(
        std::min((from.nearest_[i] - first) * scale, float{kBuckets - 1})
    );
  };
  std::array<std::uint32_t, kBuckets + 1> starts{};
  for (std::size_t i = 0; i < from.count_; ++i) ++starts[bucket(i) + 1];
  for (std::size_t b = 0; b < kBuckets; ++b) starts[b + 1] += starts[b];
  for (std::size_t i = 0; i < from.count_; ++i) {
    const std::size_t place = starts[bucket(i)]++;
    slots_[place] = from.slots_[i];
    nearest_[place] = from.nearest_[i];
  }
  count_ = from.count_;
  pad();
  nearest_from_.resize(groups());
  float bound = kInfinity;
  for (std::size_t group = groups(); group-- > 0;)
    nearest_from_[group] = bound = std::min(bound, smallest(&nearest_[kLanes * group]));
}

// ---- search
// --------------------------------------------------------------------------------------

void BeamSearch::start(
    const Beam& beam, const BeamSurfels& from, const std::vector<TracedSurfel>& surfels
) {
  beam_ = beam;
  from_ = &from;
  surfels_ = &surfels;
  next_ = 0;
  count_ = 0;
  if (stride_ < from.count_ + 2 * kLanes) {
    // An odd number of cache lines apart: columns of one surfel then fall into different sets.
    stride_ = (from.count_ + 2 * kLanes) / 32 * 32 + 48;
    columns_.resize(kColumns * stride_);
  }
  nearest_from_.clear();
  nearest_of_.clear();
}

GLINT_SIMD_INLINE EightSurfels BeamSearch::load(std::size_t group) const {
  const float* p = columns_.data() + kLanes * group;
  const auto at = [&](int c) { return Float8::load(p + static_cast<std::size_t>(c) * stride_); };
  const auto at3 = [&](int c) { return Vec3<Float8>{at(c), at(c + 1), at(c + 2)}; };
  return {
      {at3(0), at3(3), at3(6), at(9), at(kMaxRho)},
      at3(kE3),
      reinterpret_cast<Mask8::Lanes>(at(kSurfel).lanes),
      reinterpret_cast<Mask8::Lanes>(at(kSlot).lanes)};
}

GLINT_SIMD_INLINE void BeamSearch::append(const EightSurfels& s, Float8 nearest, unsigned lanes) {
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
  float* to = columns_.data() + count_;
  for (int c = 0; c < kColumns; ++c, to += stride_)
    Float8(__builtin_shuffle(columns[c].lanes, order)).store(to);
  count_ += static_cast<std::size_t>(std::popcount(lanes));
}

// Lanes behind the last surfel count nowhere.
void BeamSearch::pad() {
  float* end = columns_.data() + count_;
  for (std::size_t c = 0; c < kColumns; ++c)
    Float8(c == kMaxRho ? -1.0f : c == kNearest ? kInfinity : 0.0f).store(end + c * stride_);
}

void BeamSearch::cull_next() {
  const EightSurfels s = from_->load(next_, *surfels_);
  const BeamTest result = test(beam_, s);
  const unsigned lanes = lane_bits(result.may_meet);
  if (lanes != 0) {
    if (nearest_from_.size() * kLanes < count_ + static_cast<std::size_t>(std::popcount(lanes)))
      nearest_from_.push_back(from_->nearest_from_[next_]);
    append(s, result.nearest, lanes);
  }
  const bool last = ++next_ == from_->groups();
  if (last) pad();
  const std::size_t complete = (count_ + (last ? kLanes - 1 : 0)) / kLanes;
  while (nearest_of_.size() < complete)
    nearest_of_.push_back(smallest(&columns_[kNearest * stride_ + kLanes * nearest_of_.size()]));
}

// Whether there is such a group and it, or one behind it, may hold a hit nearer than `limit`.
GLINT_SIMD_INLINE bool BeamSearch::has_group(std::size_t group, float limit) {
  while (group >= nearest_of_.size() && next_ < from_->groups()) {
    const bool begun = group < nearest_from_.size();
    if ((begun ? nearest_from_[group] : from_->nearest_from_[next_]) > limit) return false;
    cull_next();
  }
  return group < nearest_of_.size() && nearest_from_[group] <= limit;
}

void BeamSearch::nearest(Vec3f origin, Vec3f direction, NearestHits& hits) {
  const Vec3<Float8> o = all_lanes(origin), d = all_lanes(direction);
  const float norm = length(direction) * kFurther;
  for (std::size_t group = 0; has_group(group, hits.last_t() * norm); ++group)
    if (nearest_of_[group] <= hits.last_t() * norm) offer(load(group), o, d, hits);
}

}  // namespace glint
