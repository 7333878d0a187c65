// SPDX-License-Identifier: MIT
// PNG with an alpha channel, which the product does not write: 8 bits, not compressed
// (PNG specification; RFC 1950).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

namespace glint::test {

using Rgba = std::array<std::uint8_t, 4>;

inline std::string big_bytes(std::uint32_t value, int count = 4) {
  std::string bytes;
  for (int i = count - 1; i >= 0; --i) bytes += static_cast<char>(value >> 8 * i & 0xff);
  return bytes;
}

inline std::uint32_t crc32_of(const std::string& bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

inline std::uint32_t adler32_of(const std::string& bytes) {
  std::uint32_t a = 1, b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  return b << 16 | a;
}

inline std::string png_chunk(const std::string& type, const std::string& data) {
  return big_bytes(static_cast<std::uint32_t>(data.size())) + type + data +
         big_bytes(crc32_of(type + data));
}

// Of at most 65535 bytes in all.
inline std::string rgba_png(int width, int height, const std::function<Rgba(int, int)>& pixel) {
  std::string rows;
  for (int y = 0; y < height; ++y) {
    rows += '\0';  // no filter
    for (int x = 0; x < width; ++x)
      for (const std::uint8_t value : pixel(x, y)) rows += static_cast<char>(value);
  }
  const auto size = static_cast<std::uint32_t>(rows.size());
  const auto little = [](std::uint32_t n) {
    return std::string{static_cast<char>(n & 0xff), static_cast<char>(n >> 8 & 0xff)};
  };
  const std::string stored =
      "\x78\x01\x01" + little(size) + little(~size) + rows + big_bytes(adler32_of(rows));
  const std::string header = big_bytes(static_cast<std::uint32_t>(width)) +
                             big_bytes(static_cast<std::uint32_t>(height)) +
                             std::string("\x08\x06\0\0\0", 5);
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("IDAT", stored) +
         png_chunk("IEND", "");
}

}  // namespace glint::test
