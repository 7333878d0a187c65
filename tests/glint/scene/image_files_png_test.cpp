// SPDX-License-Identifier: MIT
// PNGs made by hand, of every kind that the specification has.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <cstring>

#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"
#include "tests/support/same_bytes.h"
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

// A PNG made by hand; rows start with their filter byte.
std::string png(
    int width,
    int height,
    char depth,
    char type,
    const std::string& extra,
    const std::string& rows,
    bool interlaced = false
) {
  const std::string head = big_endian(static_cast<std::uint32_t>(width)) +
                           big_endian(static_cast<std::uint32_t>(height)) + depth + type +
                           std::string(2, '\0') + static_cast<char>(interlaced);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", head) + extra + chunk("IDAT", stored(rows)) +
         chunk("IEND", "");
}

Image read(const TempFolder& folder, const std::string& file) {
  write_file(folder / "x.png", file);
  return read_image(folder / "x.png");
}

using namespace std::string_literals;

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

// Rows of pixel bytes as a PNG stores them; filters 0 ... 4 take turns, each for three rows:
// readers may undo two at once. `unit`: bytes of a whole pixel.
std::string filtered(const std::string& bytes, int row_bytes, int unit) {
  std::string rows;
  const auto byte = [&](int y, int i) {
    if (y < 0 || i < 0) return 0;
    return static_cast<int>(static_cast<unsigned char>(bytes[y * row_bytes + i]));
  };
  for (int y = 0; y * row_bytes < static_cast<int>(bytes.size()); ++y) {
    const int filter = y / 3 % 5;
    rows += static_cast<char>(filter);
    for (int i = 0; i < row_bytes; ++i) {
      const int left = i < unit ? 0 : byte(y, i - unit);
      const int above_left = i < unit ? 0 : byte(y - 1, i - unit);
      rows += static_cast<char>(byte(y, i) - prediction(filter, left, byte(y - 1, i), above_left));
    }
  }
  return rows;
}

// A kind of PNG: bits a sample, colour type, samples a pixel.
struct Kind {
  int depth, type, samples;
  bool palette() const { return type == 3; }
  int channels() const { return (type & 2) != 0 ? 3 : 1; }
  int unit() const { return std::max(1, samples * depth / 8); }
};
constexpr Kind kKinds[] = {
    {1, 0, 1},
    {2, 0, 1},
    {4, 0, 1},
    {8, 0, 1},
    {16, 0, 1},
    {8, 2, 3},
    {16, 2, 3},
    {1, 3, 1},
    {2, 3, 1},
    {4, 3, 1},
    {8, 3, 1},
    {8, 4, 2},
    {16, 4, 2},
    {8, 6, 4},
    {16, 6, 4}};

// Random samples of a picture, [height][width][samples].
struct Samples {
  Kind kind;
  int width, height;
  std::vector<int> values;

  Samples(Kind k, int w, int h) : kind(k), width(w), height(h) {
    Rng rng(4);
    for (int i = 0; i < w * h * k.samples; ++i)
      values.push_back(static_cast<int>(rng.below(1u << k.depth)));
  }
  int at(int x, int y, int s) const { return values[(y * width + x) * kind.samples + s]; }

  // The pixels (x0 + i dx, y0 + j dy), packed and filtered.
  std::string rows(int x0, int y0, int dx, int dy) const {
    std::string bytes;
    std::size_t row_bytes = 0;
    for (int y = y0; y < height; y += dy) {
      std::string bits;
      for (int x = x0; x < width; x += dx)
        for (int s = 0; s < kind.samples; ++s)
          for (int bit = kind.depth - 1; bit >= 0; --bit)
            bits += (at(x, y, s) >> bit & 1) != 0 ? '1' : '0';
      if (bits.empty()) return "";
      bits.resize((bits.size() + 7) / 8 * 8, '0');
      row_bytes = bits.size() / 8;
      for (std::size_t i = 0; i < bits.size(); i += 8)
        bytes += static_cast<char>(std::stoi(bits.substr(i, 8), nullptr, 2));
    }
    return bytes.empty() ? "" : filtered(bytes, static_cast<int>(row_bytes), kind.unit());
  }

  std::string file(bool interlaced) const {
    std::string data;
    if (interlaced)  // Adam7
      data = rows(0, 0, 8, 8) + rows(4, 0, 8, 8) + rows(0, 4, 4, 8) + rows(2, 0, 4, 4) +
             rows(0, 2, 2, 4) + rows(1, 0, 2, 2) + rows(0, 1, 1, 2);
    else
      data = rows(0, 0, 1, 1);
    const std::string extra = kind.palette() ? chunk("PLTE", palette()) : "";
    const auto depth = static_cast<char>(kind.depth), type = static_cast<char>(kind.type);
    return png(width, height, depth, type, extra, data, interlaced);
  }

  std::string palette() const {
    std::string colors;
    for (int entry = 0; entry < 1 << kind.depth; ++entry)
      for (int c = 0; c < 3; ++c) colors += static_cast<char>(entry * (c + 1) % 251);
    return colors;
  }

  float expected(int x, int y, int c) const {
    if (kind.palette()) return static_cast<float>(at(x, y, 0) * (c + 1) % 251) / 255.0f;
    return static_cast<float>(at(x, y, c)) / static_cast<float>((1 << kind.depth) - 1);
  }
};

}  // namespace

TEST_CASE("what is written as PNG is read back, grey and colour") {
  const TempFolder folder;
  for (const int channels : {1, 3}) {
    const Image image = random_bytes(13, 7, channels);
    write_png(folder / "x.png", image);
    CHECK(same_bytes(read_image(folder / "x.png"), image));
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

TEST_CASE("damaged PNGs are found: wrong checksums, too little data") {
  const TempFolder folder;
  write_png(folder / "good.png", random_bytes(9, 6, 3));
  std::string damaged = read_file(folder / "good.png");
  damaged[50] = static_cast<char>(damaged[50] ^ 1);
  CHECK_THAT(bad_reference([&] { read(folder, damaged); }), Contains("not a complete PNG"));
  CHECK_THAT(
      bad_reference([&] { read(folder, png(4, 4, 8, 0, "", "\0\1\2\3\4"s)); }),
      Contains("not a complete PNG")
  );
}

TEST_CASE("every kind of PNG is read, with every filter, interlaced or not") {
  for (const Kind& kind : kKinds)
    for (const bool interlaced : {false, true}) {
      INFO(kind.depth << " bits, type " << kind.type << ", interlaced " << interlaced);
      const Samples samples(kind, 23, 44);
      const Image image = detail::decode_png("x.png", samples.file(interlaced));
      REQUIRE(image.size() == ImageSize{23, 44});
      REQUIRE(image.channels() == kind.channels());
      for (int y = 0; y < 44; ++y)
        for (int x = 0; x < 23; ++x)
          for (int c = 0; c < image.channels(); ++c)
            REQUIRE(image.at(x, y, c) == samples.expected(x, y, c));
    }
}

TEST_CASE("interlaced pictures smaller than a pass are read") {
  for (const int width : {1, 2, 4, 5})
    for (const int height : {1, 2, 3, 5, 9}) {
      INFO(width << " x " << height);
      const Samples samples({8, 2, 3}, width, height);
      CHECK(same_bytes(
          detail::decode_png("x.png", samples.file(true)),
          detail::decode_png("x.png", samples.file(false))
      ));
    }
}

TEST_CASE("what a picture does not need is passed over: suggested palettes, transparency, text") {
  const Samples samples({8, 2, 3}, 3, 2);
  const std::string file = samples.file(false);
  for (const std::string& extra :
       {chunk("PLTE", "\x0a\x14\x1e"s),
        chunk("tRNS", "\0\1\0\2\0\3"s),
        chunk("tEXt", "a\0b"s).substr(0, 11) + "none"}) {  // nobody needs its checksum, either
    const std::string more = file.substr(0, 33) + extra + file.substr(33);
    CHECK(same_bytes(detail::decode_png("x.png", more), detail::decode_png("x.png", file)));
  }
}

TEST_CASE("PNGs that break the rules are errors that say which") {
  const auto message = [](const std::string& file) {
    return bad_reference([&] { detail::decode_png("x.png", file); });
  };
  const std::string row = "\0\1\2\3"s;
  for (const std::size_t length : {0, 1, 3, 5, 12, 14})
    CHECK_THAT(
        message(
            "\x89PNG\r\n\x1a\n" + chunk("IHDR", std::string(length, '\1')) +
            chunk("IDAT", stored(row)) + chunk("IEND", "")
        ),
        Contains("header has a wrong length")
    );
  CHECK_THAT(message(png(1, 2, 8, 2, "", row)), Contains("do not fill"));
  CHECK_THAT(message(png(1, 1, 8, 2, "", row + row)), Contains("do not fill"));
  CHECK_THAT(message(png(1, 1, 8, 2, "", "\5\1\2\3"s)), Contains("unknown filter"));
  CHECK_THAT(message(png(1, 1, 16, 2, "", "\5\1\2\3\1\2\3"s)), Contains("unknown filter"));
  CHECK_THAT(message(png(1, 1, 4, 2, "", row)), Contains("no such kind"));
  CHECK_THAT(message(png(1, 1, 3, 0, "", row)), Contains("no such kind"));
  CHECK_THAT(message(png(1, 1, 16, 3, "", row)), Contains("no such kind"));
  CHECK_THAT(message(png(1, 1, 8, 5, "", row)), Contains("no such kind"));
  CHECK_THAT(message(png(1, 1, 8, 3, "", "\0\0"s)), Contains("beyond its palette"));
  const std::string palette = chunk("PLTE", "\1\2\3"s);
  CHECK_THAT(message(png(1, 1, 8, 3, palette, "\0\1"s)), Contains("beyond its palette"));
  CHECK_THAT(message(png(1, 1, 8, 2, chunk("ABCD", ""), row)), Contains("unknown kind"));
  std::string damaged = png(1, 1, 8, 2, "", row);
  damaged[41] = static_cast<char>(damaged[41] ^ 1);
  CHECK_THAT(message(damaged), Contains("checksum of a chunk IDAT"));
}
