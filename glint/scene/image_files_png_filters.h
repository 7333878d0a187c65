// SPDX-License-Identifier: MIT
// Undoing the filters of PNG rows (PNG specification, section 9), a pixel's bytes at once.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

namespace glint::png {

using Byte = unsigned char;

// The bytes of a pixel side by side, so that its channels are predicted together.
using Lanes [[gnu::vector_size(16)]] = std::int32_t;
using Bytes16 [[gnu::vector_size(16)]] = Byte;

// Four bytes are read at once, whose last are no part of a smaller pixel: so many bytes behind the
// last row must be there.
inline constexpr std::size_t kPadding = 3;

inline Lanes load_pixel(const Byte* from) {
  std::int32_t packed;
  std::memcpy(&packed, from, sizeof packed);
  // One byte a lane; byte 15 of what is shuffled is zero.
  constexpr Lanes kWidened = {0x0f0f0f00, 0x0f0f0f01, 0x0f0f0f02, 0x0f0f0f03};
  return (Lanes)__builtin_shuffle((Bytes16)Lanes{packed}, (Bytes16)kWidened);
}

template <int N>
void store_pixel(Byte* to, Lanes values) {
  const auto packed = (Lanes)__builtin_shuffle((Bytes16)values, Bytes16{0, 4, 8, 12});
  const auto pixel = static_cast<std::uint32_t>(packed[0]);
  if constexpr (N == 3) {  // copying three bytes would take them through memory
    const auto low = static_cast<std::uint16_t>(pixel);
    std::memcpy(to, &low, sizeof low);
    to[2] = static_cast<Byte>(pixel >> 16);
  } else {
    std::memcpy(to, &pixel, N);
  }
}

inline Lanes magnitude(Lanes v) { return v < 0 ? -v : v; }

// Predicts from left (a), above (b) and above left (c): whichever is nearest to a + b - c. Pixels
// wait for the one on their left, so little stands between `a` and the result.
inline Lanes paeth(Lanes a, Lanes b, Lanes c) {
  const Lanes up = b - c, along = a - c;
  const Lanes to_a = magnitude(up), to_b = magnitude(along), to_c = magnitude(along + up);
  const Lanes b_or_c = to_b <= to_c ? b : c;
  const Lanes nearer = to_b < to_c ? to_b : to_c;
  return to_a <= nearer ? a : b_or_c;
}

// Adds predict(left, above, above left) to every byte. What is left of a row is zero.
template <int N, class F>
void add_prediction(Byte* row, const Byte* above, std::size_t bytes, F&& predict) {
  Lanes left{}, above_left{};
  for (std::size_t i = 0; i < bytes; i += N) {
    const Lanes up = load_pixel(above + i);
    left = (load_pixel(row + i) + predict(left, up, above_left)) & 0xff;
    above_left = up;
    store_pixel<N>(row + i, left);
  }
}

inline constexpr int kPaeth = 4;

// Two rows at once, the lower a pixel behind the upper, so that neither only waits for its left.
template <int N>
void add_paeth_to_both(Byte* upper, const Byte* above, Byte* lower, std::size_t bytes) {
  Lanes left{}, above_left{}, lower_left{}, upper_left{};
  const auto finish_lower = [&](std::size_t i) {  // `left` is what stands above it
    lower_left = (load_pixel(lower + i) + paeth(lower_left, left, upper_left)) & 0xff;
    upper_left = left;
    store_pixel<N>(lower + i, lower_left);
  };
  for (std::size_t i = 0; i < bytes; i += N) {
    const Lanes up = load_pixel(above + i);
    const Lanes pixel = (load_pixel(upper + i) + paeth(left, up, above_left)) & 0xff;
    if (i > 0) finish_lower(i - N);
    store_pixel<N>(upper + i, pixel);
    above_left = up;
    left = pixel;
  }
  finish_lower(bytes - N);
}

template <int N>
bool undo_filter(int filter, Byte* row, const Byte* above, std::size_t bytes) {
  switch (filter) {
    case 0:
      return true;
    case 1:
      add_prediction<N>(row, above, bytes, [](Lanes left, Lanes, Lanes) { return left; });
      return true;
    case 2:
      for (std::size_t i = 0; i < bytes; ++i) row[i] = static_cast<Byte>(row[i] + above[i]);
      return true;
    case 3:
      add_prediction<N>(row, above, bytes, [](Lanes left, Lanes up, Lanes) {
        return (left + up) >> 1;
      });
      return true;
    case kPaeth:
      add_prediction<N>(row, above, bytes, paeth);
      return true;
    default:
      return false;
  }
}

// A byte at a time: pixels of 6 and 8 bytes.
inline int paeth_byte(int a, int b, int c) {
  const int to_a = std::abs(b - c), to_b = std::abs(a - c), to_c = std::abs(a + b - 2 * c);
  return to_a <= to_b && to_a <= to_c ? a : to_b <= to_c ? b : c;
}

inline bool undo_wide_filter(
    int filter, Byte* row, const Byte* above, std::size_t bytes, std::size_t unit
) {
  if (filter > kPaeth) return false;
  for (std::size_t i = 0; i < bytes; ++i) {
    const int left = i < unit ? 0 : row[i - unit], above_left = i < unit ? 0 : above[i - unit];
    const int predictions[] = {
        0, left, above[i], (left + above[i]) >> 1, paeth_byte(left, above[i], above_left)};
    row[i] = static_cast<Byte>(row[i] + predictions[filter]);
  }
  return true;
}

// Undoes a row; the one below, too, when both are of the slowest kind.
template <int N>
bool undo_rows(Byte* row, const Byte* above, std::size_t bytes, bool is_last) {
  if constexpr (N > 4) {
    return undo_wide_filter(row[0], row + 1, above, bytes, N);
  } else {
    Byte* next = row + bytes + 1;
    if (is_last || row[0] != kPaeth || next[0] != kPaeth)
      return undo_filter<N>(row[0], row + 1, above, bytes);
    add_paeth_to_both<N>(row + 1, above, next + 1, bytes);
    next[0] = 0;  // nothing left to undo
    return true;
  }
}

// Rows of a filter byte and `bytes` more, N bytes to a whole pixel (1 when it has fewer bits), in
// place. take(y, row) gets each as soon as it is undone. False: an unknown filter.
template <int N, class F>
bool undo_filters(Byte* rows, std::size_t bytes, int height, F&& take) {
  const std::string zeros(bytes + kPadding, '\0');
  const auto* above = reinterpret_cast<const Byte*>(zeros.data());
  for (int y = 0; y < height; ++y, rows += bytes + 1) {
    if (!undo_rows<N>(rows, above, bytes, y + 1 == height)) return false;
    above = rows + 1;
    take(y, above);
  }
  return true;
}

// The same for pixels of `unit` bytes: 1, 2, 3, 4, 6 or 8.
template <class F>
bool undo_filters(int unit, Byte* rows, std::size_t bytes, int height, F&& take) {
  switch (unit) {
    case 1:
      return undo_filters<1>(rows, bytes, height, take);
    case 2:
      return undo_filters<2>(rows, bytes, height, take);
    case 3:
      return undo_filters<3>(rows, bytes, height, take);
    case 4:
      return undo_filters<4>(rows, bytes, height, take);
    case 6:
      return undo_filters<6>(rows, bytes, height, take);
    default:
      return undo_filters<8>(rows, bytes, height, take);
  }
}

}  // namespace glint::png
