// SPDX-License-Identifier: MIT
#include "glint/core/sha256.h"

#include <fmt/format.h>

#include <bit>

namespace glint {
namespace {

using Uint128 = unsigned __int128;

// First 32 bits of the fractional part of the `degree`-th root of n: the root of n 2^(32 degree) in
// integers is the root of n in units of 2^-32. n < 2^9, so no power overflows.
constexpr std::uint32_t root_fraction(int n, int degree) {
  const Uint128 target = static_cast<Uint128>(n) << (32 * degree);
  std::uint64_t root = 0;
  for (int bit = 37; bit >= 0; --bit) {
    const std::uint64_t larger = root | (std::uint64_t{1} << bit);
    Uint128 power = 1;
    bool fits = true;
    for (int i = 0; i < degree && fits; ++i) {
      power *= larger;
      fits = power <= target;
    }
    if (fits) root = larger;
  }
  return static_cast<std::uint32_t>(root);
}

template <std::size_t kCount>
constexpr std::array<std::uint32_t, kCount> prime_root_fractions(int degree) {
  std::array<std::uint32_t, kCount> fractions{};
  std::size_t count = 0;
  for (int n = 2; count < kCount; ++n) {
    bool prime = true;
    for (int divisor = 2; divisor * divisor <= n; ++divisor) prime &= n % divisor != 0;
    if (prime) fractions[count++] = root_fraction(n, degree);
  }
  return fractions;
}

constexpr auto kInitialState = prime_root_fractions<8>(2);     // section 5.3.3
constexpr auto kRoundConstants = prime_root_fractions<64>(3);  // section 4.2.2
static_assert(kInitialState[0] == 0x6a09e667 && kRoundConstants[63] == 0xc67178f2);

// The message schedule, section 6.2.2 step 1.
std::array<std::uint32_t, 64> schedule(const std::array<unsigned char, 64>& block) {
  std::array<std::uint32_t, 64> w{};
  for (std::size_t i = 0; i < 64; ++i) w[i / 4] = (w[i / 4] << 8) | block[i];
  for (std::size_t t = 16; t < 64; ++t) {
    const std::uint32_t x = w[t - 15], y = w[t - 2];
    const std::uint32_t sigma0 = std::rotr(x, 7) ^ std::rotr(x, 18) ^ (x >> 3);
    const std::uint32_t sigma1 = std::rotr(y, 17) ^ std::rotr(y, 19) ^ (y >> 10);
    w[t] = sigma1 + w[t - 7] + sigma0 + w[t - 16];
  }
  return w;
}

}  // namespace

Sha256::Sha256() : state_(kInitialState) {}

void Sha256::update(std::string_view bytes) {
  for (const char byte : bytes) add_byte(static_cast<unsigned char>(byte));
}

void Sha256::add_byte(unsigned char byte) {
  block_[num_bytes_++ % block_.size()] = byte;
  if (num_bytes_ % block_.size() == 0) compress();
}

// Section 6.2.2 steps 2 to 4.
void Sha256::compress() {
  const std::array<std::uint32_t, 64> w = schedule(block_);
  auto [a, b, c, d, e, f, g, h] = state_;
  for (std::size_t t = 0; t < 64; ++t) {
    const std::uint32_t sum1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t sum0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t t1 = h + sum1 + ((e & f) ^ (~e & g)) + kRoundConstants[t] + w[t];
    const std::uint32_t t2 = sum0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + t1;
    d = c, c = b, b = a, a = t1 + t2;
  }
  const std::array<std::uint32_t, 8> sums = {a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < sums.size(); ++i) state_[i] += sums[i];
}

// Padding, section 5.1.1: a one bit, zeros, the length in bits as 64-bit big-endian.
std::string Sha256::finish() {
  const std::uint64_t num_bits = 8 * num_bytes_;
  add_byte(0x80);
  while (num_bytes_ % block_.size() != 56) add_byte(0);
  for (int shift = 56; shift >= 0; shift -= 8)
    add_byte(static_cast<unsigned char>((num_bits >> shift) & 0xff));
  std::string text;
  for (const std::uint32_t word : state_) text += fmt::format("{:08x}", word);
  return text;
}

}  // namespace glint
