// SPDX-License-Identifier: MIT
// PNG by libpng: reading what image_files_plain_png.cpp leaves, and writing.
#include <png.h>

#include <csetjmp>
#include <cstring>
#include <optional>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
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

struct Source {
  const char* data;
  std::size_t left;
};

void read_from_source(png_structp png, png_bytep to, std::size_t count) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (source.left < count) png_error(png, "it ends inside the data");
  std::memcpy(to, source.data, count);
  source.data += count;
  source.left -= count;
}

struct Reader {
  std::string error;
  png_structp png =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, &error, note_error, ignore_warning);
  png_infop info = png_create_info_struct(png);
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

// Palettes become colours, fewer than 8 bits become 8, 16 bits come in our byte order.
void read_header(const Reader& reader) {
  png_read_info(reader.png, reader.info);
  png_set_expand(reader.png);
  png_set_swap(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
}

template <class T>
void copy_values(const unsigned char* bytes, int full_range, Image& picture) {
  for (float& value : picture.values()) {
    T stored;
    std::memcpy(&stored, bytes, sizeof(T));
    bytes += sizeof(T);
    value = detail::unit_value(stored, full_range);
  }
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

}  // namespace

Image detail::decode_png(const fs::path& path, const std::string& file) {
  if (std::optional<Image> picture = decode_plain_png(file)) return *std::move(picture);
  Reader reader;
  Source source{file.data(), file.size()};
  png_set_read_fn(reader.png, &source, read_from_source);
  if (!completes(reader.png, [&] { read_header(reader); }))
    fail_incomplete(path, "PNG", reader.error);
  Image picture(
      static_cast<int>(png_get_image_width(reader.png, reader.info)),
      static_cast<int>(png_get_image_height(reader.png, reader.info)),
      png_get_channels(reader.png, reader.info)
  );
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  const auto height = static_cast<std::size_t>(picture.height());
  std::vector<unsigned char> bytes(row_bytes * height);
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = &bytes[y * row_bytes];
  if (!completes(reader.png, [&] { png_read_image(reader.png, rows.data()); }))
    fail_incomplete(path, "PNG", reader.error);
  if (png_get_bit_depth(reader.png, reader.info) == 16)
    copy_values<std::uint16_t>(bytes.data(), 65535, picture);
  else
    copy_values<unsigned char>(bytes.data(), 255, picture);
  return picture;
}

std::string detail::encode_png(MaskView image) {
  Writer writer;
  std::string file;
  png_set_write_fn(writer.png, &file, append_to_file, flush_nothing);
  const auto row_bytes =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  const bool written = completes(writer.png, [&] {
    png_set_IHDR(
        writer.png,
        writer.info,
        static_cast<png_uint_32>(image.width),
        static_cast<png_uint_32>(image.height),
        8,
        image.channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB,
        PNG_INTERLACE_NONE,
        PNG_COMPRESSION_TYPE_DEFAULT,
        PNG_FILTER_TYPE_DEFAULT
    );
    png_set_compression_level(writer.png, kCompressionLevel);
    png_write_info(writer.png, writer.info);
    for (int y = 0; y < image.height; ++y)
      png_write_row(writer.png, image.data + static_cast<std::size_t>(y) * row_bytes);
    png_write_end(writer.png, writer.info);
  });
  GLINT_CHECK(written, kEnvironment, "encoding a PNG failed: {}", writer.error);
  return file;
}

}  // namespace glint
