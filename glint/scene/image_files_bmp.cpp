// SPDX-License-Identifier: MIT
// BMP as cameras, screenshots and MATLAB write it: not compressed, 24 or 32 bits, or 8 bits with a
// palette (BITMAPINFOHEADER and its successors). The fourth byte of 32 bits is no alpha that anyone
// agrees on, and is dropped.
#include <cstring>

#include "glint/core/error.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

std::uint32_t little_endian(std::string_view file, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = count; i-- > 0;)
    value = value << 8 | (at + i < file.size() ? static_cast<unsigned char>(file[at + i]) : 0);
  return value;
}

struct BmpLayout {
  std::int64_t width = 0, height = 0;
  std::size_t pixels_at = 0, palette_at = 0, colors = 0;
  std::size_t bytes = 0;  // a pixel
  bool top_down = false;

  std::size_t row_bytes() const { return (static_cast<std::size_t>(width) * bytes + 3) / 4 * 4; }
};

BmpLayout layout_of(const fs::path& path, std::string_view file) {
  constexpr std::size_t kFileHeader = 14, kInfoHeader = 40;
  constexpr std::uint32_t kUncompressed = 0, kBitFields = 3;
  const std::size_t header = little_endian(file, kFileHeader, 4);
  if (file.size() < kFileHeader + kInfoHeader) detail::fail_incomplete(path, "BMP", "its header");
  const std::uint32_t bits = little_endian(file, 28, 2), compression = little_endian(file, 30, 4);
  const bool usual_fields =
      bits == 32 && compression == kBitFields && little_endian(file, 54, 4) == 0xff0000 &&
      little_endian(file, 58, 4) == 0xff00 && little_endian(file, 62, 4) == 0xff;
  GLINT_CHECK(
      header >= kInfoHeader && (bits == 8 || bits == 24 || bits == 32) &&
          (compression == kUncompressed || usual_fields),
      kBadReference,
      "{}: BMP of {} bits a pixel, compression {}; expected 8, 24 or 32 bits, not compressed; save "
      "it as PNG",
      path.string(),
      bits,
      compression
  );
  const auto height = static_cast<std::int32_t>(little_endian(file, 22, 4));
  const std::size_t stated_colors = little_endian(file, 46, 4);
  return {
      static_cast<std::int32_t>(little_endian(file, 18, 4)),
      std::abs(static_cast<std::int64_t>(height)),
      little_endian(file, 10, 4),
      kFileHeader + header,
      stated_colors == 0 || stated_colors > 256 ? 256 : stated_colors,
      bits / 8,
      height < 0};
}

}  // namespace

detail::ClaimedSize detail::bmp_size(const fs::path& path, std::string_view file) {
  const BmpLayout layout = layout_of(path, file);
  return {layout.width, layout.height, 3};
}

Image detail::decode_bmp(const fs::path& path, std::string_view file) {
  const BmpLayout layout = layout_of(path, file);
  const std::size_t rows = static_cast<std::size_t>(layout.height) * layout.row_bytes();
  if (layout.pixels_at > file.size() || file.size() - layout.pixels_at < rows)
    fail_incomplete(path, "BMP", "its pixels are missing");
  Image picture(static_cast<int>(layout.width), static_cast<int>(layout.height), 3);
  for (int y = 0; y < picture.height(); ++y) {
    const auto stored_row =
        static_cast<std::size_t>(layout.top_down ? y : picture.height() - 1 - y);
    for (int x = 0; x < picture.width(); ++x) {
      std::size_t at = layout.pixels_at + stored_row * layout.row_bytes() +
                       static_cast<std::size_t>(x) * layout.bytes;
      if (layout.bytes == 1) {
        const std::size_t entry = little_endian(file, at, 1);
        if (entry >= layout.colors) fail_incomplete(path, "BMP", "a colour beyond its palette");
        at = layout.palette_at + 4 * entry;
      }
      for (int c = 0; c < 3; ++c)  // stored as B G R
        picture.at(x, y, c) = unit_value(
            static_cast<int>(little_endian(file, at + 2 - static_cast<std::size_t>(c), 1)), 255
        );
    }
  }
  return picture;
}

}  // namespace glint
