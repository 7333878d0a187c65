// SPDX-License-Identifier: MIT
// Pictures with alpha in every format that may have it, composed on a grey, and formats that are
// read alone: WebP, BMP.
#include <tiffio.h>
#include <webp/encode.h>

#include <catch2/catch.hpp>

#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "tests/support/rgba_png.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr int kWidth = 5, kHeight = 3;

Rgba color_at(int x, int y) {
  return {
      static_cast<std::uint8_t>(50 * x),
      static_cast<std::uint8_t>(80 * y),
      static_cast<std::uint8_t>(200 - 10 * x),
      static_cast<std::uint8_t>(x == 0 ? 0 : 255 - 60 * y)};
}

std::vector<std::uint8_t> rgba_bytes() {
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (const std::uint8_t value : color_at(x, y)) bytes.push_back(value);
  return bytes;
}

// The formula of compositing, by hand: a c + (1 - a) b, all in [0, 1].
void check_composed(const fs::path& file) {
  CHECK(has_alpha(file));
  for (const float background : {0.0f, 1.0f}) {
    const Image image = read_composed(file, 3, background);
    REQUIRE(image.size() == ImageSize{kWidth, kHeight});
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < 3; ++c) {
          const Rgba color = color_at(x, y);
          const double alpha = color[3] / 255.0;
          const double expected = alpha * color[static_cast<std::size_t>(c)] / 255.0 +
                                  (1 - alpha) * static_cast<double>(background);
          CHECK(static_cast<double>(image.at(x, y, c)) == Approx(expected).margin(1e-6));
        }
  }
  const Image alpha = read_alpha(file);
  CHECK(static_cast<double>(alpha.at(2, 1)) == Approx(195 / 255.0).margin(1e-6));
  CHECK(static_cast<double>(alpha.at(0, 1)) == Approx(0).margin(1e-6));
}

std::string webp(bool with_alpha) {
  const std::vector<std::uint8_t> pixels = rgba_bytes();
  std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
  if (with_alpha) {
    WebPConfig config;
    WebPPicture picture;
    REQUIRE(WebPConfigInit(&config));
    REQUIRE(WebPPictureInit(&picture));
    config.lossless = config.exact = 1;  // colours below transparent pixels, too
    picture.use_argb = 1;
    picture.width = kWidth, picture.height = kHeight;
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    REQUIRE(WebPPictureImportRGBA(&picture, pixels.data(), 4 * kWidth));
    REQUIRE(WebPEncode(&config, &picture));
    WebPPictureFree(&picture);
    std::string file(reinterpret_cast<const char*>(writer.mem), writer.size);
    WebPMemoryWriterClear(&writer);
    return file;
  }
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 != 3) rgb.push_back(pixels[i]);
  size = WebPEncodeLosslessRGB(rgb.data(), kWidth, kHeight, 3 * kWidth, &bytes);
  REQUIRE(size > 0);
  std::string file(reinterpret_cast<const char*>(bytes), size);
  WebPFree(bytes);
  return file;
}

void write_tiff(const fs::path& path, bool premultiplied) {
  TIFF* file = TIFFOpen(path.c_str(), "w");
  REQUIRE(file != nullptr);
  const std::uint16_t kind = premultiplied ? EXTRASAMPLE_ASSOCALPHA : EXTRASAMPLE_UNASSALPHA;
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, kWidth);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, kHeight);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 4);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 32);
  TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  TIFFSetField(file, TIFFTAG_EXTRASAMPLES, 1, &kind);
  for (int y = 0; y < kHeight; ++y) {
    std::vector<float> row;
    for (int x = 0; x < kWidth; ++x) {
      const Rgba color = color_at(x, y);
      const float alpha = static_cast<float>(color[3]) / 255;
      for (std::size_t c = 0; c < 3; ++c)
        row.push_back((premultiplied ? alpha : 1) * static_cast<float>(color[c]) / 255);
      row.push_back(alpha);
    }
    TIFFWriteScanline(file, row.data(), static_cast<std::uint32_t>(y), 0);
  }
  TIFFClose(file);
}

// Not compressed: header of 13 bytes, further chunks, rows.
std::string png(
    const std::string& kind, const std::vector<std::string>& chunks, const std::string& rows
) {
  const auto size = static_cast<std::uint32_t>(rows.size());
  const auto little = [](std::uint32_t n) {
    return std::string{static_cast<char>(n & 0xff), static_cast<char>(n >> 8 & 0xff)};
  };
  std::string file = "\x89PNG\r\n\x1a\n" +
                     png_chunk("IHDR", big_bytes(2) + big_bytes(1) + kind + std::string(3, '\0'));
  for (const std::string& chunk : chunks) file += chunk;
  return file +
         png_chunk(
             "IDAT",
             "\x78\x01\x01" + little(size) + little(~size) + rows + big_bytes(adler32_of(rows))
         ) +
         png_chunk("IEND", "");
}

std::string little_bytes(std::uint32_t value, int count) {
  std::string bytes = big_bytes(value, count);
  return {bytes.rbegin(), bytes.rend()};
}

// Two pixels wide, two rows high; `pixels`: rows with their padding.
std::string bmp(int bits, int height, const std::string& palette, const std::string& pixels) {
  const auto start = static_cast<std::uint32_t>(54 + palette.size());
  return "BM" + little_bytes(start, 4) + little_bytes(0, 4) + little_bytes(start, 4) +
         little_bytes(40, 4) + little_bytes(2, 4) +
         little_bytes(static_cast<std::uint32_t>(height), 4) + little_bytes(1, 2) +
         little_bytes(static_cast<std::uint32_t>(bits), 2) + little_bytes(0, 4) +
         std::string(12, '\0') + little_bytes(static_cast<std::uint32_t>(palette.size() / 4), 4) +
         little_bytes(0, 4) + palette + pixels;
}

}  // namespace

TEST_CASE("pictures with alpha are laid on a grey in PNG, WebP and TIFF") {
  const TempFolder folder;
  write_file(folder / "x.png", rgba_png(kWidth, kHeight, color_at));
  check_composed(folder / "x.png");
  write_file(folder / "x.webp", webp(true));
  check_composed(folder / "x.webp");
  for (const bool premultiplied : {false, true}) {
    write_tiff(folder / "x.tif", premultiplied);
    check_composed(folder / "x.tif");
  }
}

TEST_CASE("of a damaged picture the reader tells, not the look for alpha") {
  const TempFolder folder;
  write_file(folder / "x.tif", "II*");
  CHECK_FALSE(has_alpha(folder / "x.tif"));
  CHECK_THAT(bad_reference([&] { read_composed(folder / "x.tif", 3, 0); }), Contains("x.tif"));
}

TEST_CASE("transparent colours of a PNG's palette, and a colour that counts as transparent") {
  const TempFolder folder;
  const std::string colors("\xff\x00\x00\x00\xff\x00", 6);
  const std::string palette = png_chunk("PLTE", colors);
  const auto composed = [&](const std::string& file) {
    write_file(folder / "x.png", file);
    CHECK(has_alpha(folder / "x.png"));
    return read_composed(folder / "x.png", 3, 1);
  };
  const std::string indices("\0\0\1", 3);  // filter, first colour, second
  const Image of_palette = composed(png("\x08\x03", {palette, png_chunk("tRNS", "\x33")}, indices));
  CHECK(of_palette.at(0, 0, 0) == Approx(1));
  CHECK(of_palette.at(0, 0, 1) == Approx(0.8));  // 0.2 of red on white
  CHECK(of_palette.at(1, 0, 0) == Approx(0));    // beyond the chunk: opaque
  CHECK(of_palette.at(1, 0, 1) == Approx(1));

  const std::string key("\0\xff\0\0\0\0", 6);  // red, as 16 bits a sample
  const Image of_key = composed(png("\x08\x02", {png_chunk("tRNS", key)}, '\0' + colors));
  CHECK(of_key.at(0, 0, 1) == Approx(1));
  CHECK(of_key.at(1, 0, 0) == Approx(0));

  write_file(folder / "opaque.png", png("\x08\x03", {palette}, indices));
  CHECK_FALSE(has_alpha(folder / "opaque.png"));
}

TEST_CASE("WebP is read, damage and animations are errors that name the file") {
  const TempFolder folder;
  const std::string file = webp(false);
  write_file(folder / "x.webp", file);
  const Image image = read_image(folder / "x.webp");
  CHECK_FALSE(has_alpha(folder / "x.webp"));
  CHECK(stores_integers(folder / "x.webp"));
  CHECK(read_image_size(folder / "x.webp") == ImageSize{kWidth, kHeight});
  CHECK(image.at(3, 2, 0) == Approx(150 / 255.0));
  CHECK(image.at(3, 2, 1) == Approx(160 / 255.0));
  CHECK(image.at(3, 2, 2) == Approx(170 / 255.0));
  for (std::size_t length = 0; length < file.size(); length += 5) {
    write_file(folder / "cut.webp", file.substr(0, length));
    CHECK_THAT(bad_reference([&] { read_image(folder / "cut.webp"); }), Contains("cut.webp"));
  }
  std::string animated = "RIFF" + little_bytes(22, 4) + "WEBPVP8X" + little_bytes(10, 4) +
                         std::string("\x02\0\0\0\x04\0\0\x02\0\0", 10);
  write_file(folder / "a.webp", animated);
  CHECK_THAT(bad_reference([&] { read_image(folder / "a.webp"); }), Contains("a.webp"));
}

TEST_CASE("BMP of 8, 24 and 32 bits, from below and from above") {
  const TempFolder folder;
  const auto read = [&](const std::string& file) {
    write_file(folder / "x.bmp", file);
    return read_image(folder / "x.bmp");
  };
  const std::string top("\x01\x02\x03\x04\x05\x06\0\0", 8),
      bottom("\x11\x12\x13\x14\x15\x16\0\0", 8);
  for (const Image& image :
       {read(bmp(24, 2, "", bottom + top)), read(bmp(24, -2, "", top + bottom))}) {
    REQUIRE(image.size() == ImageSize{2, 2});
    CHECK(image.at(1, 0, 0) == Approx(6 / 255.0));  // stored as B G R
    CHECK(image.at(0, 1, 2) == Approx(0x11 / 255.0));
  }
  CHECK(read(bmp(32, 1, "", std::string("\1\2\3\0\4\5\6\0", 8))).at(1, 0, 1) == Approx(5 / 255.0));
  const std::string palette("\1\2\3\0\4\5\6\0", 8);
  CHECK(read(bmp(8, 1, palette, std::string("\1\0\0\0", 4))).at(0, 0, 0) == Approx(6 / 255.0));
  CHECK(stores_integers(folder / "x.bmp"));

  const auto message = [&](const std::string& file) { return bad_reference([&] { read(file); }); };
  CHECK_THAT(message(bmp(8, 1, palette, std::string("\2\0\0\0", 4))), Contains("palette"));
  CHECK_THAT(message(bmp(24, 2, "", top)), Contains("x.bmp: not a complete BMP"));
  CHECK_THAT(message(bmp(16, 2, "", top + bottom)), Contains("BMP of 16 bits"));
  CHECK_THAT(message(bmp(24, 30000, "", top)), Contains("x.bmp: "));
  CHECK_THAT(message("BM"), Contains("x.bmp: not a complete BMP"));
}
