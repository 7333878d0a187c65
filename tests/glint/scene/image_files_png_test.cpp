// SPDX-License-Identifier: MIT
// PNGs made by hand: the fast reader of plain ones, and libpng for the others.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <cstring>

#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

Image random_bytes(int width, int height, int channels) {
  Rng rng(9);
  Image image(width, height, channels);
  for (float& value : image.values()) value = static_cast<float>(rng.below(256)) / 255.0f;
  return image;
}

bool same(const Image& a, const Image& b) {
  return a.size() == b.size() && a.channels() == b.channels() &&
         std::memcmp(a.data(), b.data(), a.values().size_bytes()) == 0;
}

std::uint32_t checksum(const std::string& bytes) {  // CRC-32 of the PNG specification
  std::uint32_t crc = ~0u;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

std::string big_endian(std::uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xff);
  return text;
}

std::string chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data +
         big_endian(checksum(type + data));
}

// zlib's format with one stored block.
std::string stored(const std::string& data) {
  std::uint32_t a = 1, b = 0;  // Adler-32
  for (const char byte : data) {
    a = (a + static_cast<unsigned char>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  const auto n = static_cast<std::uint16_t>(data.size());
  std::string text("\x78\x01\x01", 3);
  for (const std::uint16_t v : {n, static_cast<std::uint16_t>(~n)}) {
    text += static_cast<char>(v & 0xff);
    text += static_cast<char>(v >> 8);
  }
  return text + data + big_endian(b << 16 | a);
}

// A PNG made by hand; rows start with their filter byte, 0.
std::string png(
    int width, int height, char depth, char type, const std::string& extra, const std::string& rows
) {
  const std::string head = big_endian(static_cast<std::uint32_t>(width)) +
                           big_endian(static_cast<std::uint32_t>(height)) + depth + type +
                           std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", head) + extra + chunk("IDAT", stored(rows)) +
         chunk("IEND", "");
}

Image read(const TempFolder& folder, const std::string& file) {
  write_file(folder / "x.png", file);
  return read_image(folder / "x.png");
}

using namespace std::string_literals;

int type_of(int channels) { return channels == 1 ? 0 : channels == 2 ? 4 : channels == 3 ? 2 : 6; }

// What the specification predicts for byte i of a row from those left, above and above left.
int prediction(int filter, int left, int above, int above_left) {
  const int p = left + above - above_left;
  const int pa = std::abs(p - left), pb = std::abs(p - above), pc = std::abs(p - above_left);
  switch (filter) {
    case 1:
      return left;
    case 2:
      return above;
    case 3:
      return (left + above) / 2;
    case 4:
      return pa <= pb && pa <= pc ? left : pb <= pc ? above : above_left;
    default:
      return 0;
  }
}

// Rows of pixel bytes as a PNG stores them; filters 0 ... 4 take turns, each for three rows: some
// readers undo two at once.
std::string filtered(const std::string& bytes, int row_bytes, int channels) {
  std::string rows;
  const auto byte = [&](int y, int i) {
    if (y < 0 || i < 0) return 0;
    return static_cast<int>(static_cast<unsigned char>(bytes[y * row_bytes + i]));
  };
  for (int y = 0; y * row_bytes < static_cast<int>(bytes.size()); ++y) {
    const int filter = y / 3 % 5;
    rows += static_cast<char>(filter);
    for (int i = 0; i < row_bytes; ++i) {
      const int left = i < channels ? 0 : byte(y, i - channels);
      const int above_left = i < channels ? 0 : byte(y - 1, i - channels);
      rows += static_cast<char>(byte(y, i) - prediction(filter, left, byte(y - 1, i), above_left));
    }
  }
  return rows;
}

}  // namespace

TEST_CASE("what is written as PNG is read back, grey and colour") {
  const TempFolder folder;
  for (const int channels : {1, 3}) {
    const Image image = random_bytes(13, 7, channels);
    write_png(folder / "x.png", image);
    CHECK(same(read_image(folder / "x.png"), image));
    CHECK(read_image_size(folder / "x.png") == ImageSize{13, 7});
  }
}

TEST_CASE("16 bits, palettes, single bits and alpha come out as colours") {
  const TempFolder folder;
  const Image wide = read(folder, png(2, 1, 16, 0, "", "\0\x30\x39\xff\xff"s));
  REQUIRE(wide.channels() == 1);
  CHECK(wide.at(0, 0) == 12345.0f / 65535.0f);
  CHECK(wide.at(1, 0) == 1.0f);
  const std::string palette = chunk("PLTE", "\x0a\x14\x1e\xff\0\0"s);
  const Image indexed = read(folder, png(2, 1, 8, 3, palette, "\0\1\0"s));
  REQUIRE(indexed.channels() == 3);
  CHECK(indexed.at(0, 0, 0) == 1.0f);
  CHECK(indexed.at(1, 0, 2) == 30 / 255.0f);
  const Image bits = read(folder, png(3, 1, 1, 0, "", "\0\xa0"s));
  REQUIRE(bits.channels() == 1);
  CHECK(bits.at(0, 0) == 1.0f);
  CHECK(bits.at(1, 0) == 0.0f);
  const Image alpha = read(folder, png(1, 1, 8, 6, "", "\0\x33\x66\xcc\0"s));
  REQUIRE(alpha.channels() == 3);
  CHECK(alpha.at(0, 0, 0) == 51 / 255.0f);
  CHECK(alpha.at(0, 0, 2) == 204 / 255.0f);
}

TEST_CASE("damaged PNGs are found: cut-off files, wrong checksums, too little data") {
  const TempFolder folder;
  write_png(folder / "good.png", random_bytes(9, 6, 3));
  const std::string good = read_file(folder / "good.png");
  for (std::size_t length = 0; length < good.size(); ++length)
    bad_reference([&] { read(folder, good.substr(0, length)); });
  std::string damaged = good;
  damaged[50] = static_cast<char>(damaged[50] ^ 1);
  CHECK_THAT(bad_reference([&] { read(folder, damaged); }), Contains("not a complete PNG"));
  CHECK_THAT(
      bad_reference([&] { read(folder, png(4, 4, 8, 0, "", "\0\1\2\3\4"s)); }),
      Contains("not a complete PNG")
  );
}

TEST_CASE("every filter is undone, by the fast reader and by libpng") {
  constexpr int kWidth = 23, kHeight = 44;
  Rng rng(4);
  const TempFolder folder;
  for (const int channels : {1, 2, 3, 4}) {
    INFO(channels);
    const int row_bytes = kWidth * channels;
    std::string bytes;
    for (int i = 0; i < row_bytes * kHeight; ++i) bytes += static_cast<char>(rng.below(256));
    const std::string rows = filtered(bytes, row_bytes, channels);
    const auto type = static_cast<char>(type_of(channels));
    const std::string plain = png(kWidth, kHeight, 8, type, "", rows);
    const auto fast = detail::decode_plain_png(plain);
    REQUIRE(fast);
    REQUIRE(fast->channels() == channels);
    for (std::size_t i = 0; i < bytes.size(); ++i)
      REQUIRE(fast->values()[i] == static_cast<float>(static_cast<unsigned char>(bytes[i])) / 255);
    if (channels < 3) continue;
    // A suggested palette, which changes nothing.
    const std::string other = png(kWidth, kHeight, 8, type, chunk("PLTE", "\x0a\x14\x1e"s), rows);
    CHECK_FALSE(detail::decode_plain_png(other));
    CHECK(same(detail::decode_png("x.png", other), *fast));
  }
}

TEST_CASE("a header that is too short is no plain PNG") {
  for (const std::size_t length : {0, 1, 3, 5, 12, 14}) {
    const std::string file = "\x89PNG\r\n\x1a\n" + chunk("IHDR", std::string(length, '\1')) +
                             chunk("IDAT", stored("\0\1\2\3"s)) + chunk("IEND", "");
    CHECK_FALSE(detail::decode_plain_png(file));
  }
}

TEST_CASE("the fast reader leaves to libpng what it does not know") {
  const std::string row = "\0\1\2\3"s;
  CHECK(detail::decode_plain_png(png(1, 1, 8, 2, "", row)));
  CHECK_FALSE(detail::decode_plain_png(png(1, 1, 16, 0, "", "\0\1\2"s)));
  CHECK_FALSE(detail::decode_plain_png(png(1, 1, 8, 3, chunk("PLTE", "\1\2\3"s), "\0\0"s)));
  CHECK_FALSE(detail::decode_plain_png(png(1, 1, 8, 2, chunk("tRNS", "\0\1\0\2\0\3"s), row)));
  CHECK_FALSE(detail::decode_plain_png(png(1, 2, 8, 2, "", row)));          // too few rows
  CHECK_FALSE(detail::decode_plain_png(png(1, 1, 8, 2, "", row + row)));    // too many
  CHECK_FALSE(detail::decode_plain_png(png(1, 1, 8, 2, "", "\5\1\2\3"s)));  // no such filter
}
