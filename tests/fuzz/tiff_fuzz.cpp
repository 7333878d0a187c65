// SPDX-License-Identifier: MIT
#include <tiffio.h>

#include "glint/scene/image_files.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.tiff");
  return accepts([&] { read_image(file); });
}

FuzzInput tiff(const std::string& name, int bits, int channels, int compression) {
  return written(name, [&](const fs::path& path) {
    TIFF* file = TIFFOpen(path.c_str(), "w");
    TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 3);
    TIFFSetField(file, TIFFTAG_IMAGELENGTH, 2);
    TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, channels);
    TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(file, TIFFTAG_SAMPLEFORMAT, bits == 32 ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
    TIFFSetField(file, TIFFTAG_COMPRESSION, compression);
    TIFFSetField(
        file, TIFFTAG_PHOTOMETRIC, channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB
    );
    std::vector<unsigned char> row(static_cast<std::size_t>(3 * channels * bits / 8), 60);
    for (std::uint32_t y = 0; y < 2; ++y) TIFFWriteScanline(file, row.data(), y, 0);
    TIFFClose(file);
  });
}

std::vector<FuzzInput> seeds() {
  return {
      tiff("float", 32, 1, COMPRESSION_NONE),
      tiff("float_lzw", 32, 1, COMPRESSION_LZW),
      tiff("rgb_deflate", 8, 3, COMPRESSION_ADOBE_DEFLATE),
      tiff("grey16_packbits", 16, 1, COMPRESSION_PACKBITS)};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"tiff", read, seeds})

}  // namespace glint::fuzz
