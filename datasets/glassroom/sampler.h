// SPDX-License-Identifier: MIT
// Points in the unit square for one sample of one pixel. The first dimensions of all samples of a
// pixel form Owen-scrambled, independently shuffled (0,2)-sequences, [Burley20] "Practical
// Hash-based Owen Scrambling": stratified in both axes and all elementary intervals at powers of
// two. The rest is plain PCG32. Everything is a function of (seed, view, pixel, sample).
#pragma once

#include <cstdint>

#include "glint/core/rng.h"
#include "glint/core/vec.h"

namespace glint::path_tracing {

// Finaliser of SplitMix64 [Steele14]: neighbouring inputs give unrelated outputs.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(x);
}

// Laine-Karras permutation with the constants of [Burley20]: bit k of the result depends on bits
// 0..k only, which on reversed bits is a nested uniform (Owen) scrambling.
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  return x ^ (x * 0x8d22f6e6u);
}

// Pascal's triangle mod 2 times the bits of `index`: the generator matrix of the second Sobol
// dimension is the fivefold Kronecker product of [1 1; 0 1], so five shift-and-xor steps apply it.
constexpr std::uint32_t pascal_times(std::uint32_t index) {
  index ^= (index >> 1) & 0x55555555u;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 8) & 0x00ff00ffu;
  return index ^ ((index >> 16) & 0x0000ffffu);
}

// [0, 1), 24 bits.
constexpr float unit_interval(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

class Sampler {
 public:
  static constexpr int kStratifiedPairs = 8;

  // `pixel_key`: from pixel_key() below; `index`: the sample's number in its pixel.
  Sampler(std::uint64_t pixel_key, std::uint32_t index)
      : key_(pixel_key),
        index_(reverse_bits(index)),
        rng_(mix_bits(pixel_key + index), pixel_key) {}

  Vec2f next_2d() {
    if (pair_ >= kStratifiedPairs) {
      const float x = rng_.uniform();
      return {x, rng_.uniform()};
    }
    const std::uint64_t a = mix_bits(key_ + static_cast<std::uint64_t>(2 * pair_));
    const std::uint64_t b = mix_bits(key_ + static_cast<std::uint64_t>(2 * pair_ + 1));
    ++pair_;
    const std::uint32_t i = reverse_bits(scramble_reversed(index_, static_cast<std::uint32_t>(a)));
    return {
        unit_interval(reverse_bits(scramble_reversed(i, static_cast<std::uint32_t>(a >> 32)))),
        unit_interval(reverse_bits(scramble_reversed(pascal_times(i), static_cast<std::uint32_t>(b))
        ))};
  }
  float next_1d() { return rng_.uniform(); }

 private:
  std::uint64_t key_;
  std::uint32_t index_;  // bits reversed
  int pair_ = 0;
  Rng rng_;
};

// `branch` tells independent paths of one pixel apart (transmission and reflection).
constexpr std::uint64_t pixel_key(
    std::uint64_t seed, std::uint64_t view, std::uint64_t pixel, std::uint64_t branch
) {
  return mix_bits(mix_bits(mix_bits(mix_bits(seed) + view) + pixel) + branch);
}

}  // namespace glint::path_tracing
