// SPDX-License-Identifier: MIT
#include "glint/render/nearest_hits.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "glint/render/blend.h"
#include "glint/render/surfel_lanes.h"

namespace glint {

namespace {

constexpr std::uint32_t kLastSurfel = 0x7fffffff;
constexpr int kLookInterval = 16;  // hits
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

NearestHits::NearestHits(float near, float min_alpha, float min_transmittance)
    : after_{std::max(near, 0.0f), kLastSurfel, 0, 0},
      last_{},
      min_alpha_(min_alpha),
      min_transmittance_(min_transmittance) {}

void NearestHits::start(float transmittance, std::size_t most) {
  if (count_ > 0) after_ = sorted_[count_ - 1];
  last_ = {kFarthest, kLastSurfel, 0, 0};
  transmittance_ = transmittance;
  most_ = static_cast<int>(std::min<std::size_t>(most, kSize));
  count_ = 0;
  next_look_ = kLookInterval;
  cut_ = false;
}

bool NearestHits::finish() {
  sort();
  while (count_ > 0 && last_ < sorted_[count_ - 1]) --count_;  // ties in t
  return cut_;
}

void NearestHits::add(Float8 t, Float8 alpha, Mask8 met, Mask8::Lanes surfels, Mask8::Lanes slots) {
  const Float8 after_t(after_.t);
  const Mask8 later{surfels > static_cast<std::int32_t>(after_.surfel)};
  const Mask8 behind = (t > after_t) | ((t == after_t) & later);
  append(t, alpha, lane_bits(met & behind & (alpha >= Float8(min_alpha_))), surfels, slots);
}

void NearestHits::append(
    Float8 t, Float8 alpha, unsigned lanes, Mask8::Lanes surfels, Mask8::Lanes slots
) {
  const Mask8::Lanes order = kPackTable.order(lanes);
  Float8(__builtin_shuffle(t.lanes, order)).store(ts_ + count_);
  Float8(__builtin_shuffle(alpha.lanes, order)).store(alphas_ + count_);
  store_integers(__builtin_shuffle(surfels, order), surfels_ + count_);
  store_integers(__builtin_shuffle(slots, order), slots_ + count_);
  count_ += std::popcount(lanes);
  if (count_ >= next_look_) shorten();
}

// A hit's rank is the number of nearer ones. Equal t show in the sum of the ranks.
void NearestHits::sort() {
  constexpr int kAtOnce = 2 * Float8::kLanes;
  std::fill_n(ts_ + count_, kAtOnce, kInfinity);
  alignas(32) std::uint32_t ranks[kSize];
  for (int i = 0; i < count_; i += kAtOnce) {
    const Float8 low = Float8::load(ts_ + i), high = Float8::load(ts_ + i + Float8::kLanes);
    Mask8::Lanes low_rank{}, high_rank{};
    for (int k = 0; k < count_; ++k) {
      const Float8 t(ts_[k]);
      low_rank -= (t < low).lanes;
      high_rank -= (t < high).lanes;
    }
    store_integers(low_rank, ranks + i);
    store_integers(high_rank, ranks + i + Float8::kLanes);
  }
  unsigned sum = 0;
  for (int i = 0; i < count_; ++i) {
    sorted_[ranks[i]] = hit(i);
    sum += ranks[i];
  }
  if (2 * sum != static_cast<unsigned>(count_ * (count_ - 1))) sort_ties();
}

void NearestHits::sort_ties() {
  for (int i = 0; i < count_; ++i) sorted_[i] = hit(i);
  std::sort(sorted_, sorted_ + count_);
}

// Bounds the transmittance behind all hits found so far from above, but for rounding.
bool NearestHits::may_stop() {
  std::fill_n(alphas_ + count_, Float8::kLanes, 0.0f);
  Float8 clear(1.0f);
  for (int i = 0; i < count_; i += Float8::kLanes)
    clear = clear * (Float8(1.0f) - Float8::load(alphas_ + i));
  float transmittance = transmittance_;
  for (int lane = 0; lane < Float8::kLanes; ++lane) transmittance *= clear[lane];
  return transmittance < min_transmittance_;
}

// Hits behind the one that stops the ray do not matter, whatever else is found in front of it.
int NearestHits::hits_until_stop() const {
  float transmittance = transmittance_;
  for (int i = 0; i < count_; ++i) {
    transmittance = blend_step(transmittance, sorted_[i].alpha, min_transmittance_).transmittance;
    if (transmittance < 0) return i + 1;
  }
  return count_;
}

void NearestHits::shorten() {
  if (count_ >= kCapacity || count_ > most_ || may_stop()) {
    sort();
    const int enough = std::min(hits_until_stop(), most_);
    cut_after(enough < kCapacity ? enough : kCapacity / 2);
  }
  next_look_ = std::min(count_ + kLookInterval, kCapacity);
}

void NearestHits::keep_first(int count) {
  for (int i = 0; i < count; ++i) {
    ts_[i] = sorted_[i].t;
    alphas_[i] = sorted_[i].alpha;
    surfels_[i] = sorted_[i].surfel;
    slots_[i] = sorted_[i].slot;
  }
  count_ = count;
}

void NearestHits::cut_after(int count) {
  keep_first(count);
  last_ = sorted_[count - 1];
  cut_ = true;
}

}  // namespace glint
