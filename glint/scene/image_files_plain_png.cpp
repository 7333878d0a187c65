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
using Bytes4 [[gnu::vector_size(4)]] = Byte;
using Bytes16 [[gnu::vector_size(16)]] = Byte;

// Four bytes, whose last are no part of a pixel of fewer channels: buffers have as many more.
constexpr std::size_t kPadding = 3;

Lanes load_pixel(const Byte* from) {
  Bytes4 bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  return __builtin_convertvector(bytes, Lanes);
}

template <int N>
void store_pixel(Byte* to, Lanes values) {
  Bytes16 bytes;
  std::memcpy(&bytes, &values, sizeof bytes);
  const Bytes16 low = __builtin_shuffle(bytes, Bytes16{0, 4, 8, 12});
  std::memcpy(to, &low, N);
}

Lanes magnitude(Lanes v) { return v < 0 ? -v : v; }

// Predicts from left (a), above (b) and above left (c): whichever is nearest to a + b - c.
Lanes paeth(Lanes a, Lanes b, Lanes c) {
  const Lanes to_a = magnitude(b - c), to_b = magnitude(a - c), to_c = magnitude(a + b - 2 * c);
  const Lanes b_or_c = to_b <= to_c ? b : c;
  return ((to_a <= to_b) & (to_a <= to_c)) ? a : b_or_c;
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
    case 4:
      add_prediction<N>(row, above, bytes, paeth);
      return true;
    default:
      return false;
  }
}

// Rows of a filter byte and pixels, then kPadding; false: an unknown filter.
template <int N>
bool unfilter_into(Byte* rows, Image& picture) {
  const std::size_t bytes = static_cast<std::size_t>(picture.width()) * N;
  const std::string zeros(bytes + kPadding, '\0');
  const auto* above = reinterpret_cast<const Byte*>(zeros.data());
  for (int y = 0; y < picture.height(); ++y, rows += bytes + 1) {
    if (!undo_filter<N>(rows[0], rows + 1, above, bytes)) return false;
    above = rows + 1;
    float* to = &picture.at(0, y);
    for (std::size_t i = 0; i < bytes; ++i) to[i] = detail::unit_value(above[i], 255);
  }
  return true;
}

bool unfilter(Byte* rows, Image& picture) {
  switch (picture.channels()) {
    case 1:
      return unfilter_into<1>(rows, picture);
    case 2:
      return unfilter_into<2>(rows, picture);
    case 3:
      return unfilter_into<3>(rows, picture);
    default:
      return unfilter_into<4>(rows, picture);
  }
}

}  // namespace

std::optional<Image> detail::decode_plain_png(std::string_view file) {
  const std::optional<PlainPng> png = plain_parts(file);
  if (!png) return std::nullopt;
  const auto row_bytes = static_cast<std::size_t>(png->width) * png->channels + 1;
  const std::size_t num_bytes = row_bytes * static_cast<std::size_t>(png->height);
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
  Image picture(png->width, png->height, png->channels);
  if (!unfilter(rows.get(), picture)) return std::nullopt;
  return picture;
}

}  // namespace glint
