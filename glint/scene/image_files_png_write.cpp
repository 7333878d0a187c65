// SPDX-License-Identifier: MIT
// Writing PNG by libpng.
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstddef>
#include <string>

#include "glint/core/error.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

void note_error(png_structp png, png_const_charp message) {
  *static_cast<std::string*>(png_get_error_ptr(png)) = message;
  png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

// Runs body(), which libpng leaves by longjmp when it fails: it must hold nothing that needs a
// destructor.
template <class F>
bool completes(png_structp png, F&& body) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  body();
  return true;
}

constexpr int kCompressionLevel = 1;  // a fifth of the time of zlib's default, 5 to 10 % more bytes

struct Writer {
  std::string error;
  png_structp png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, &error, note_error, ignore_warning);
  png_infop info = png_create_info_struct(png);
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

void append_to_file(png_structp png, png_bytep bytes, std::size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))
      ->append(reinterpret_cast<const char*>(bytes), count);
}
void flush_nothing(png_structp) {}

// Rows of `row_bytes` bytes; 16-bit values as the machine has them.
std::string encode_rows(
    ImageSize size, int channels, int bits, const unsigned char* rows, std::size_t row_bytes
) {
  Writer writer;
  std::string file;
  png_set_write_fn(writer.png, &file, append_to_file, flush_nothing);
  const bool written = completes(writer.png, [&] {
    png_set_IHDR(
        writer.png,
        writer.info,
        static_cast<png_uint_32>(size.width),
        static_cast<png_uint_32>(size.height),
        bits,
        channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB,
        PNG_INTERLACE_NONE,
        PNG_COMPRESSION_TYPE_DEFAULT,
        PNG_FILTER_TYPE_DEFAULT
    );
    png_set_compression_level(writer.png, kCompressionLevel);
    png_write_info(writer.png, writer.info);
    if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(writer.png);
    for (int y = 0; y < size.height; ++y)
      png_write_row(writer.png, rows + static_cast<std::size_t>(y) * row_bytes);
    png_write_end(writer.png, writer.info);
  });
  GLINT_CHECK(written, kEnvironment, "encoding a PNG failed: {}", writer.error);
  return file;
}

}  // namespace

std::string detail::encode_png(MaskView image) {
  const auto row_bytes =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  return encode_rows(image.size(), image.channels, 8, image.data, row_bytes);
}

std::string detail::encode_png16(ImageSize size, const std::uint16_t* grey) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(grey);
  return encode_rows(size, 1, 16, bytes, 2 * static_cast<std::size_t>(size.width));
}

}  // namespace glint
