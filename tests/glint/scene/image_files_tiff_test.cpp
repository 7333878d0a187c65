// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include <tiffio.h>

#include <vector>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

// As 2DGS' render.py writes depth: float32, one channel, here with a compression or none.
template <class T>
void write_tiff(
    const fs::path& path, int width, const std::vector<T>& values, int format, int compression
) {
  const int height = static_cast<int>(values.size()) / width;
  TIFF* file = TIFFOpen(path.c_str(), "w");
  REQUIRE(file != nullptr);
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * sizeof(T)));
  TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, format);
  TIFFSetField(file, TIFFTAG_COMPRESSION, compression);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  for (int y = 0; y < height; ++y) {
    std::vector<T> row(values.begin() + y * width, values.begin() + (y + 1) * width);
    TIFFWriteScanline(file, row.data(), static_cast<std::uint32_t>(y), 0);
  }
  TIFFClose(file);
}

}  // namespace

TEST_CASE("TIFF of float32 and of integers is read as stored") {
  const test::TempFolder folder;
  const std::vector<float> depth = {0, 1.25f, -3, 1e6f, 2.5f, 7};
  for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW}) {
    write_tiff(folder / "depth.tiff", 3, depth, SAMPLEFORMAT_IEEEFP, compression);
    const Image image = read_image(folder / "depth.tiff", 1);
    CHECK_FALSE(stores_integers(folder / "depth.tiff"));
    CHECK(image.size() == ImageSize{3, 2});
    CHECK(std::vector<float>(image.values().begin(), image.values().end()) == depth);
  }
  const std::vector<std::uint16_t> grey = {0, 65535, 13107, 6};
  write_tiff(folder / "grey.tif", 2, grey, SAMPLEFORMAT_UINT, COMPRESSION_NONE);
  CHECK(read_image(folder / "grey.tif", 1).at(0, 1) == Approx(0.2));
  CHECK(stores_integers(folder / "grey.tif"));
  write_tiff(
      folder / "bytes.tif", 2, std::vector<std::uint8_t>(4), SAMPLEFORMAT_UINT, COMPRESSION_NONE
  );
  CHECK(stores_integers(folder / "bytes.tif"));
}

TEST_CASE("A damaged TIFF is refused by name") {
  const test::TempFolder folder;
  write_file(folder / "depth.tiff", "II*");
  CHECK_THROWS_WITH(read_image(folder / "depth.tiff"), Catch::Contains("depth.tiff"));
  write_tiff(
      folder / "cut.tiff", 64, std::vector<float>(64 * 64), SAMPLEFORMAT_IEEEFP, COMPRESSION_NONE
  );
  const std::string whole = read_file(folder / "cut.tiff");
  for (const std::size_t bytes : {8, 100, 5000}) {
    write_file(folder / "cut.tiff", whole.substr(0, bytes));
    CHECK_THROWS_AS(read_image(folder / "cut.tiff"), Error);
  }
  const std::vector<double> values(4);
  write_tiff(folder / "double.tiff", 2, values, SAMPLEFORMAT_IEEEFP, COMPRESSION_NONE);
  CHECK_THROWS_WITH(read_image(folder / "double.tiff"), Catch::Contains("TIFF of 64 bits"));
}

TEST_CASE("The orientation that libtiff writes is told") {
  const test::TempFolder folder;
  for (const int orientation : {1, 3, 6, 8}) {
    TIFF* file = TIFFOpen((folder / "x.tif").c_str(), orientation == 6 ? "wb" : "wl");
    REQUIRE(file != nullptr);
    for (const auto& [tag, value] :
         {std::pair(TIFFTAG_IMAGEWIDTH, 2),
          {TIFFTAG_IMAGELENGTH, 1},
          {TIFFTAG_BITSPERSAMPLE, 8},
          {TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK},
          {TIFFTAG_ORIENTATION, orientation}})
      TIFFSetField(file, static_cast<std::uint32_t>(tag), value);
    std::uint8_t row[] = {1, 2};
    TIFFWriteScanline(file, row, 0, 0);
    TIFFClose(file);
    CHECK(stated_orientation(folder / "x.tif") == orientation);
  }
}
