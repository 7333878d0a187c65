// SPDX-License-Identifier: MIT
// The PNGs that most pictures are: 8 bits a channel, no palette, not interlaced. Inflated by
// libdeflate, which is twice as fast as zlib; scoring pictures is mostly waiting for that. Any
// other file, and any damaged one, is left to libpng. Filters: PNG specification, section 9.
#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

using detail::big_endian;
using Byte = unsigned char;

struct FreeDecompressor {
  void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
};

struct PlainPng {
  int width = 0, height = 0, channels = 0;
  std::string deflated;
};

// Channels by the colour type of IHDR; 0: not plain.
int plain_channels(std::string_view header) {
  constexpr std::string_view kEightBit = "\x08";
  const bool plain = header.size() == 13 && header.substr(8, 1) == kEightBit && header[10] == 0 &&
                     header[11] == 0 && header[12] == 0;
  if (!plain) return 0;
  switch (header[9]) {
    case 0:
      return 1;
    case 2:
      return 3;
    case 4:
      return 2;
    case 6:
      return 4;
    default:
      return 0;
  }
}

// One chunk; false: not plain.
bool take_chunk(std::string_view type, std::string_view data, PlainPng& png) {
  if (type == "IHDR") {
    png.channels = plain_channels(data);
    if (png.channels == 0) return false;
    png.width = static_cast<int>(big_endian(data.substr(0, 4)));
    png.height = static_cast<int>(big_endian(data.substr(4, 4)));
    return true;
  }
  if (type == "IDAT") png.deflated += data;
  return type != "tRNS" && type != "PLTE";
}

// The chunks of a file whose lengths were checked.
std::optional<PlainPng> plain_parts(std::string_view file) {
  PlainPng png;
  png.deflated.reserve(file.size());
  for (std::size_t at = 8; at + 12 <= file.size();) {
    const std::size_t length = big_endian(file.substr(at, 4));
    const std::string_view type = file.substr(at + 4, 4), data = file.substr(at + 8, length);
    const std::uint32_t checksum = libdeflate_crc32(0, type.data(), 4 + length);
    const bool first = at == 8;
    if (checksum != big_endian(file.substr(at + 8 + length, 4)) || first != (type == "IHDR") ||
        !take_chunk(type, data, png))
      return std::nullopt;
    if (type == "IEND") return png;
    at += 12 + length;
  }
  return std::nullopt;
}

// The bytes of a pixel side by side, so that its channels are predicted together.
using Lanes [[gnu::vector_size(16)]] = std::int32_t;
using Bytes16 [[gnu::vector_size(16)]] = Byte;

// Four bytes, whose last are no part of a pixel of fewer channels: buffers have as many more.
constexpr std::size_t kPadding = 3;

Lanes load_pixel(const Byte* from) {
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

Lanes magnitude(Lanes v) { return v < 0 ? -v : v; }

// Predicts from left (a), above (b) and above left (c): whichever is nearest to a + b - c. Pixels
// wait for the one on their left, so little stands between `a` and the result.
Lanes paeth(Lanes a, Lanes b, Lanes c) {
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

constexpr int kPaeth = 4;

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

// The values of rows of a filter byte and pixels, then kPadding; none: an unknown filter.
template <int N>
std::optional<Array<float>> unfilter_pixels(Byte* rows, std::size_t bytes, int height) {
  const std::string zeros(bytes + kPadding, '\0');
  const auto* above = reinterpret_cast<const Byte*>(zeros.data());
  Array<float> values;
  values.reserve(bytes * static_cast<std::size_t>(height));
  std::vector<float> row(bytes);
  for (int y = 0; y < height; ++y, rows += bytes + 1) {
    Byte* next = rows + bytes + 1;
    if (y + 1 < height && rows[0] == kPaeth && next[0] == kPaeth) {
      add_paeth_to_both<N>(rows + 1, above, next + 1, bytes);
      next[0] = 0;  // nothing left to undo
    } else if (!undo_filter<N>(rows[0], rows + 1, above, bytes)) {
      return std::nullopt;
    }
    above = rows + 1;
    for (std::size_t i = 0; i < bytes; ++i) row[i] = detail::unit_value(above[i], 255);
    values.insert(values.end(), row.begin(), row.end());
  }
  return values;
}

std::optional<Array<float>> unfilter(const PlainPng& png, Byte* rows, std::size_t bytes) {
  switch (png.channels) {
    case 1:
      return unfilter_pixels<1>(rows, bytes, png.height);
    case 2:
      return unfilter_pixels<2>(rows, bytes, png.height);
    case 3:
      return unfilter_pixels<3>(rows, bytes, png.height);
    default:
      return unfilter_pixels<4>(rows, bytes, png.height);
  }
}

}  // namespace

std::optional<Image> detail::decode_plain_png(std::string_view file) {
  const std::optional<PlainPng> png = plain_parts(file);
  if (!png) return std::nullopt;
  const auto row_bytes = static_cast<std::size_t>(png->width) * png->channels;
  const std::size_t num_bytes = (row_bytes + 1) * static_cast<std::size_t>(png->height);
  const auto rows = std::make_unique_for_overwrite<Byte[]>(num_bytes + kPadding);
  std::fill_n(&rows[num_bytes], kPadding, Byte{0});
  const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor(
      libdeflate_alloc_decompressor()
  );
  if (decompressor == nullptr) return std::nullopt;
  const auto result = libdeflate_zlib_decompress(
      decompressor.get(),
      png->deflated.data(),
      png->deflated.size(),
      rows.get(),
      num_bytes,
      nullptr  // exactly as many bytes
  );
  if (result != LIBDEFLATE_SUCCESS) return std::nullopt;
  std::optional<Array<float>> values = unfilter(*png, rows.get(), row_bytes);
  if (!values) return std::nullopt;
  return Image(png->width, png->height, png->channels, std::move(*values));
}

}  // namespace glint
