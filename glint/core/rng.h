// SPDX-License-Identifier: MIT
// Deterministic random numbers, the same on every machine: PCG32 [O'Neill 2014]. Streams make
// independent sequences, so that parallel work draws the same numbers with any number of threads.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

namespace glint {

class Rng {
 public:
  explicit Rng(std::uint64_t seed, std::uint64_t stream = 0) : increment_((stream << 1u) | 1u) {
    next_u32();
    state_ += seed;
    next_u32();
  }

  std::uint32_t next_u32() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ull + increment_;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
    const auto rotation = static_cast<std::uint32_t>(old >> 59u);
    return (xorshifted >> rotation) | (xorshifted << ((32u - rotation) & 31u));
  }

  // Uniform in [0, 1), 24 bits.
  float uniform() { return static_cast<float>(next_u32() >> 8) * 0x1p-24f; }
  float uniform(float low, float high) { return low + (high - low) * uniform(); }
  // Uniform integer in [0, n).
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(next_u32()) * n) >> 32u);
  }
  // Standard normal by Box-Muller (one of the pair is dropped: no hidden state).
  float normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - static_cast<double>(uniform())));
    return static_cast<float>(
        radius * std::cos(6.283185307179586 * static_cast<double>(uniform()))
    );
  }

  // Where it stands, for checkpoints.
  template <class State>
  void visit_state(State& state) {
    state("state", state_);
    state("increment", increment_);
  }

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
};

// FNV-1a: stable seeds from names.
constexpr std::uint64_t hash_name(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return hash;
}

}  // namespace glint
