// SPDX-License-Identifier: MIT
// The list that a search for a ray's nearest hits fills.
#pragma once

#include <cstdint>
#include <limits>

#include "glint/core/simd.h"

namespace glint {

// A hit's place on its ray is (t, surfel), t >= 0.
struct FoundHit {
  float t;
  std::uint32_t surfel;  // below 2^31
  std::uint32_t slot;
  float alpha;

  bool operator<(const FoundHit& other) const {
    return t < other.t || (t == other.t && surfel < other.surfel);
  }
  bool operator==(const FoundHit& other) const { return t == other.t && surfel == other.surfel; }
};

// Hits strictly behind `after`, up to the place where the ray stops or where the list had to be
// cut. Unsorted and structure of arrays while they are found: appending eight and sorting many at
// once take no branches that depend on the data.
class NearestHits {
 public:
  static constexpr int kCapacity = 128;
  static constexpr float kFarthest = std::numeric_limits<float>::max();

  // The first search is for t > near. Hits fainter than min_alpha do not count.
  // A ray ends in front of the hit that would take its transmittance below min_transmittance.
  NearestHits(float near, float min_alpha, float min_transmittance);

  // Before a search: `transmittance` is what the ray has left there; hits behind the first `most`,
  // at least 1, are not asked for.
  void start(float transmittance, std::size_t most = kCapacity);
  // After it: sorts. Returns whether there may be hits behind the last of these; start() then goes
  // on from there.
  bool finish();
  int count() const { return count_; }
  const FoundHit& operator[](int i) const { return sorted_[i]; }

  // For the search. Hits behind last_t() do not matter.
  float after_t() const { return after_.t; }
  float last_t() const { return last_.t; }
  // Of eight surfels, those in `met`.
  void add(Float8 t, Float8 alpha, Mask8 met, Mask8::Lanes surfels, Mask8::Lanes slots);

 private:
  void append(Float8 t, Float8 alpha, unsigned lanes, Mask8::Lanes surfels, Mask8::Lanes slots);
  FoundHit hit(int i) const { return {ts_[i], surfels_[i], slots_[i], alphas_[i]}; }
  void sort();
  void sort_ties();
  void shorten();
  bool may_stop();
  int hits_until_stop() const;
  void keep_first(int count);
  void cut_after(int count);

  static constexpr int kSize = kCapacity + 3 * Float8::kLanes;  // whole vectors are appended
  FoundHit after_, last_;
  float min_alpha_, min_transmittance_, transmittance_ = 1;
  int count_ = 0;
  int most_ = kCapacity;
  int next_look_ = 0;  // count at which to shorten
  bool cut_ = false;
  alignas(32) float ts_[kSize];
  alignas(32) float alphas_[kSize];
  alignas(32) std::uint32_t surfels_[kSize];
  alignas(32) std::uint32_t slots_[kSize];
  FoundHit sorted_[kSize];
};

}  // namespace glint
