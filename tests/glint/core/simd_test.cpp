// SPDX-License-Identifier: MIT
// Every operation on eight lanes must give, to the bit, what the scalar one gives on each.
#include "glint/core/simd.h"

#include <bit>
#include <catch2/catch.hpp>

#include "glint/core/rng.h"
#include "glint/core/vec.h"

using namespace glint;

namespace {

struct Lanes {
  float values[Float8::kLanes];
  Float8 load() const { return Float8::load(values); }
};

Lanes random_lanes(Rng& rng, float low, float high) {
  Lanes lanes;
  for (float& value : lanes.values) value = rng.uniform(low, high);
  return lanes;
}

// f: a generic function of two numbers.
template <class F>
void check_lanes(F&& f, float low, float high) {
  Rng rng(hash_name("simd lanes"));
  for (int round = 0; round < 100; ++round) {
    const Lanes a = random_lanes(rng, low, high), b = random_lanes(rng, low, high);
    const Float8 result = f(a.load(), b.load());
    for (int i = 0; i < Float8::kLanes; ++i) {
      const float expected = f(a.values[i], b.values[i]);
      CHECK(std::bit_cast<std::uint32_t>(result[i]) == std::bit_cast<std::uint32_t>(expected));
    }
  }
}

}  // namespace

TEST_CASE("Arithmetic on lanes equals scalar arithmetic") {
  check_lanes([](auto a, auto b) { return a + b; }, -10, 10);
  check_lanes([](auto a, auto b) { return a - b; }, -10, 10);
  check_lanes([](auto a, auto b) { return a * b; }, -10, 10);
  check_lanes([](auto a, auto b) { return a / b; }, 0.1f, 10);
  check_lanes([](auto a, auto) { return -a; }, -10, 10);
  check_lanes([](auto a, auto b) { return fma_of(a, b, a); }, -10, 10);
}

TEST_CASE("Functions of lanes equal the scalar functions") {
  check_lanes([](auto a, auto b) { return min_of(a, b); }, -10, 10);
  check_lanes([](auto a, auto b) { return max_of(a, b); }, -10, 10);
  check_lanes([](auto a, auto) { return abs_of(a); }, -10, 10);
  check_lanes([](auto a, auto) { return sqrt_of(a); }, 0, 10);
  check_lanes([](auto a, auto) { return exp_bounded(a); }, -87, 87);
  check_lanes([](auto a, auto) { return exp_fast(a); }, -100, 100);
}

TEST_CASE("Selection by comparison works lane by lane") {
  check_lanes([](auto a, auto b) { return select(a < b, a, b); }, -1, 1);
  check_lanes([](auto a, auto b) { return select(a >= b, a, b); }, -1, 1);
  check_lanes([](auto a, auto b) { return keep(a < b, a); }, -1, 1);
}

TEST_CASE("Any and all see every lane") {
  for (int i = 0; i < Float8::kLanes; ++i) {
    Lanes lanes{};
    lanes.values[i] = 1;
    CHECK(any(lanes.load() > Float8(0.5f)));
    CHECK_FALSE(all(lanes.load() > Float8(0.5f)));
    CHECK_FALSE(all(lanes.load() < Float8(0.5f)));
  }
  CHECK(all(Float8(1.0f) > Float8(0.5f)));
  CHECK_FALSE(any(Float8(0.0f) > Float8(0.5f)));
}

TEST_CASE("Lanes are numbered from zero and stored in order") {
  float stored[Float8::kLanes];
  lane_indices<Float8>().store(stored);
  for (int i = 0; i < Float8::kLanes; ++i) CHECK(stored[i] == static_cast<float>(i));
}
