// SPDX-License-Identifier: MIT
// PNG by libpng: linked with the lean codec in place of OpenCV's.
#include <catch2/catch.hpp>
#include <cstring>

#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
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

}  // namespace

TEST_CASE("what the lean codec writes it reads back, grey and colour") {
  const TempFolder folder;
  for (const int channels : {1, 3}) {
    const Image image = random_bytes(13, 7, channels);
    write_png(folder / "x.png", image);
    CHECK(same(read_image(folder / "x.png"), image));
    CHECK(read_image_size(folder / "x.png") == ImageSize{13, 7});
  }
}

TEST_CASE("16 bits, palettes, single bits and alpha come out as OpenCV gives them") {
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

TEST_CASE("the lean codec finds damage: cut-off files, wrong checksums, too little data") {
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

TEST_CASE("JPEG and resizing are errors that name the full build") {
  const TempFolder folder;
  write_file(folder / "x.jpg", "\xff\xd8\xff\xc0\0\x0b\x08\0\2\0\2\1\1\x11\0\xff\xd9"s);
  CHECK_THAT(
      error_of(ExitCode::kEnvironment, [&] { read_image(folder / "x.jpg"); }),
      Contains("reads no JPEG")
  );
  CHECK_THAT(
      error_of(
          ExitCode::kEnvironment,
          [&] {
            resize_image(Image(4, 4, 1), {2, 2});
          }
      ),
      Contains("dataset pack --max-pixels")
  );
}
