// SPDX-License-Identifier: MIT
// TIFF by libtiff: the depth maps of 2DGS and its successors (float32, one channel), and integers.
#include <tiffio.h>

#include <cstring>
#include <memory>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"
#include "glint/scene/image_files_stored.h"

namespace glint {
namespace {

using TiffFile = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

struct TiffLayout {
  std::uint32_t width = 0, height = 0;
  std::uint16_t channels = 1, bits = 1, format = SAMPLEFORMAT_UINT, planes = PLANARCONFIG_CONTIG;
  bool premultiplied = false;  // associated alpha, in TIFF's words

  std::size_t colors() const { return channels < 3 ? 1 : 3; }
  bool has_alpha() const { return channels == 2 || channels == 4; }

  bool is_float() const { return format == SAMPLEFORMAT_IEEEFP && bits == 32; }
  bool is_integer() const { return format == SAMPLEFORMAT_UINT && (bits == 8 || bits == 16); }
};

TiffLayout layout_of(TIFF* file, const fs::path& path) {
  TiffLayout layout;
  TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &layout.width);
  TIFFGetField(file, TIFFTAG_IMAGELENGTH, &layout.height);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &layout.channels);
  TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &layout.bits);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLEFORMAT, &layout.format);
  TIFFGetFieldDefaulted(file, TIFFTAG_PLANARCONFIG, &layout.planes);
  std::uint16_t extra = 0, *kinds = nullptr;
  TIFFGetFieldDefaulted(file, TIFFTAG_EXTRASAMPLES, &extra, &kinds);
  layout.premultiplied = extra > 0 && kinds[0] == EXTRASAMPLE_ASSOCALPHA;
  GLINT_CHECK(
      (layout.is_float() || layout.is_integer()) && layout.channels <= 4 &&
          layout.planes == PLANARCONFIG_CONTIG && TIFFIsTiled(file) == 0,
      kBadReference,
      "{}: TIFF of {} bits, {} channels{}; expected float32 or 8 or 16 bits, 1 to 4 channels, in "
      "strips",
      path.string(),
      layout.bits,
      layout.channels,
      TIFFIsTiled(file) != 0 ? ", in tiles" : ""
  );
  const detail::ClaimedSize size{layout.width, layout.height, layout.channels};
  detail::check_claimed_size(path, size, fs::file_size(path));
  return layout;
}

float value_at(const std::vector<unsigned char>& row, std::size_t i, const TiffLayout& layout) {
  if (layout.is_float()) {
    float value;
    std::memcpy(&value, row.data() + 4 * i, sizeof value);
    return value;
  }
  if (layout.bits == 8) return detail::unit_value(row[i], 255);
  std::uint16_t value;
  std::memcpy(&value, row.data() + 2 * i, sizeof value);
  return detail::unit_value(value, 65535);
}

// The first 1 or 3 channels of a row: what follows is alpha, by which they may be laid on a grey.
void read_row(
    TIFF* file,
    const fs::path& path,
    const TiffLayout& layout,
    std::optional<float> background,
    int y,
    Image& image
) {
  const auto bytes = static_cast<std::size_t>(layout.width) * layout.channels * (layout.bits / 8u);
  std::vector<unsigned char> row(std::max(bytes, static_cast<std::size_t>(TIFFScanlineSize64(file)))
  );
  if (TIFFReadScanline(file, row.data(), static_cast<std::uint32_t>(y), 0) != 1)
    detail::fail_incomplete(path, "TIFF", fmt::format("row {} is missing", y));
  const bool compose = background && layout.has_alpha();
  for (int x = 0; x < image.width(); ++x) {
    const std::size_t first = static_cast<std::size_t>(x) * layout.channels;
    const float alpha = compose ? value_at(row, first + layout.colors(), layout) : 1;
    for (std::size_t c = 0; c < layout.colors(); ++c)
      image.at(x, y, static_cast<int>(c)) =
          (layout.premultiplied ? 1 : alpha) * value_at(row, first + c, layout) +
          (compose ? (1 - alpha) * *background : 0);
  }
}

TiffFile open_tiff(const fs::path& path) {
  check_exists(path);
  TIFFSetWarningHandler(nullptr);  // messages are ours
  TIFFSetErrorHandler(nullptr);
  TiffFile file(TIFFOpen(path.c_str(), "r"), TIFFClose);
  if (!file) detail::fail_incomplete(path, "TIFF", "the header cannot be read");
  return file;
}

Image read_by_libtiff(const fs::path& path, std::optional<float> background) {
  const TiffFile file = open_tiff(path);
  const TiffLayout layout = layout_of(file.get(), path);
  Image image(
      static_cast<int>(layout.width),
      static_cast<int>(layout.height),
      static_cast<int>(layout.colors())
  );
  for (int y = 0; y < image.height(); ++y) read_row(file.get(), path, layout, background, y, image);
  return image;
}

int range_by_libtiff(const fs::path& path) {
  const TiffLayout layout = layout_of(open_tiff(path).get(), path);
  return layout.is_integer() ? (1 << layout.bits) - 1 : 0;
}

bool alpha_by_libtiff(const fs::path& path) {
  return layout_of(open_tiff(path).get(), path).has_alpha();
}

}  // namespace

GLINT_PROVIDE(tiff_has_alpha, alpha_by_libtiff)
GLINT_PROVIDE(read_tiff, read_by_libtiff)
GLINT_PROVIDE(tiff_integer_range, range_by_libtiff)

}  // namespace glint
