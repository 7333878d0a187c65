// SPDX-License-Identifier: MIT
// PNG, all of it: every depth and colour type, palettes, interlacing (PNG specification). Inflated
// by libdeflate at once, which is twice as fast as zlib in pieces: scoring pictures is mostly
// waiting for that (docs/reference/metrics.md has the times). Alpha, which colour types, palettes
// and a colour that counts as transparent may bring, is dropped or laid on a background.
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "glint/core/error.h"
#include "glint/scene/image_files_formats.h"
#include "glint/scene/image_files_png_filters.h"

namespace glint {
namespace {

using detail::big_endian;
using png::Byte;

enum ColorType { kGrey = 0, kColor = 2, kPalette = 3, kGreyAlpha = 4, kColorAlpha = 6 };

struct PngFormat {
  int width = 0, height = 0, depth = 0, type = 0;  // depth: bits of a sample
  bool interlaced = false;

  int samples() const {  // a pixel
    constexpr std::array<int, 7> kSamples{1, 0, 3, 1, 2, 0, 4};
    return kSamples[static_cast<std::size_t>(type)];
  }
  int channels() const { return (type & kColor) != 0 ? 3 : 1; }  // of the picture
  int unit_bytes() const { return std::max(1, samples() * depth / 8); }
  std::size_t row_bytes(int pixels) const {
    return (static_cast<std::size_t>(pixels) * samples() * depth + 7) / 8;
  }
};

struct PngParts {
  PngFormat format;
  std::string_view palette;       // R G B
  std::string_view transparency;  // of tRNS: alpha of the palette's colours, or the colour without
  std::string deflated;
};

// Every n-th pixel of the picture, from where on.
struct Pass {
  int x, y, step_x, step_y;
  int width(const PngFormat& f) const { return (f.width - x + step_x - 1) / step_x; }
  int height(const PngFormat& f) const { return (f.height - y + step_y - 1) / step_y; }
  std::size_t bytes(const PngFormat& f) const {
    if (width(f) == 0) return 0;
    return (f.row_bytes(width(f)) + 1) * static_cast<std::size_t>(height(f));
  }
};
constexpr Pass kWhole[] = {{0, 0, 1, 1}};
constexpr Pass kAdam7[] = {
    {0, 0, 8, 8},
    {4, 0, 8, 8},
    {0, 4, 4, 8},
    {2, 0, 4, 4},
    {0, 2, 2, 4},
    {1, 0, 2, 2},
    {0, 1, 1, 2}};

std::span<const Pass> passes_of(const PngFormat& format) {
  if (format.interlaced) return kAdam7;
  return kWhole;
}

struct Chunk {
  std::string_view body;  // four letters, then data
  std::uint32_t checksum = 0;
  std::string_view type() const { return body.substr(0, 4); }
  std::string_view data() const { return body.substr(4); }
};

void check_png(const fs::path& path, bool good, std::string_view what) {
  if (!good) detail::fail_incomplete(path, "PNG", what);
}

// All of a file behind its signature, IHDR first, IEND last.
std::vector<Chunk> chunks_of(const fs::path& path, std::string_view file) {
  constexpr std::size_t kSignature = 8, kOverhead = 12;  // length, type, checksum
  std::vector<Chunk> chunks;
  for (std::size_t at = kSignature; chunks.empty() || chunks.back().type() != "IEND";) {
    check_png(path, at + kOverhead <= file.size(), "it ends inside a chunk");
    const std::size_t length = big_endian(file.substr(at, 4));
    check_png(path, length <= file.size() - at - kOverhead, "it ends inside a chunk");
    chunks.push_back({file.substr(at + 4, 4 + length), big_endian(file.substr(at + 8 + length, 4))}
    );
    const bool header = chunks.back().type() == "IHDR";
    check_png(path, header == (at == kSignature), "it has no header, or two");
    check_png(path, !header || length == 13, "its header has a wrong length");
    at += kOverhead + length;
  }
  return chunks;
}

struct FreeDecompressor {
  void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
};

class PngReader {
 public:
  PngReader(const fs::path& path, std::optional<float> background)
      : path_(path), background_(background) {}

  Image read(std::string_view file) {
    take_chunks(file);
    inflate();
    return format().interlaced ? interlaced_picture() : whole_picture();
  }

 private:
  const PngFormat& format() const { return parts_.format; }

  void check(bool good, std::string_view what) const { check_png(path_, good, what); }

  void take_chunks(std::string_view file) {
    parts_.deflated.reserve(file.size());
    for (const Chunk& chunk : chunks_of(path_, file)) {
      const bool is_transparency = background_ && chunk.type() == "tRNS";
      if (!is_critical(chunk.type()) && !is_transparency) continue;
      check(
          libdeflate_crc32(0, chunk.body.data(), chunk.body.size()) == chunk.checksum,
          fmt::format("the checksum of a chunk {} is wrong", chunk.type())
      );
      take_chunk(chunk.type(), chunk.data());
    }
  }

  static bool is_critical(std::string_view type) { return type[0] >= 'A' && type[0] <= 'Z'; }

  void take_chunk(std::string_view type, std::string_view data) {
    if (type == "IHDR")
      take_header(data);
    else if (type == "PLTE")
      parts_.palette = data;
    else if (type == "tRNS")
      parts_.transparency = data;
    else if (type == "IDAT")
      parts_.deflated += data;
    else
      check(type == "IEND", "it has a chunk of an unknown kind that is needed to read it");
  }

  void take_header(std::string_view data) {
    const auto byte = [&](std::size_t i) {
      return static_cast<int>(big_endian(data.substr(i, 1)));
    };
    PngFormat& f = parts_.format;
    f.width = static_cast<int>(big_endian(data.substr(0, 4)));
    f.height = static_cast<int>(big_endian(data.substr(4, 4)));
    f.depth = byte(8);
    f.type = byte(9);
    f.interlaced = byte(12) == 1;
    constexpr int kDepths[] = {1, 2, 4, 8, 16};
    const bool depth =
        std::find(std::begin(kDepths), std::end(kDepths), f.depth) != std::end(kDepths);
    const bool pair =
        f.type == kGrey || (f.type == kPalette && f.depth <= 8) ||
        ((f.type == kColor || f.type == kGreyAlpha || f.type == kColorAlpha) && f.depth >= 8);
    check(
        depth && pair,
        fmt::format("{} bits a sample of colour type {}: there is no such kind", f.depth, f.type)
    );
    check(f.width > 0 && f.height > 0, "its header gives no size");
    check(
        byte(10) == 0 && byte(11) == 0 && byte(12) <= 1,
        "its header names an unknown compression, filter or interlacing"
    );
  }

  void inflate() {
    std::size_t num_bytes = 0;
    for (const Pass& pass : passes_of(format())) num_bytes += pass.bytes(format());
    rows_ = std::make_unique_for_overwrite<Byte[]>(num_bytes + png::kPadding);
    std::fill_n(&rows_[num_bytes], png::kPadding, Byte{0});
    const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor(
        libdeflate_alloc_decompressor()
    );
    GLINT_CHECK(decompressor != nullptr, kEnvironment, "out of memory while reading a PNG");
    const auto result = libdeflate_zlib_decompress(
        decompressor.get(),
        parts_.deflated.data(),
        parts_.deflated.size(),
        rows_.get(),
        num_bytes,
        nullptr  // exactly as many bytes
    );
    check(
        result == LIBDEFLATE_SUCCESS,
        result == LIBDEFLATE_BAD_DATA ? "its pixels are damaged"
                                      : "its pixels do not fill the size in its header"
    );
  }

  Image whole_picture() {
    const PngFormat& f = format();
    Array<float> values;
    values.reserve(static_cast<std::size_t>(f.width) * f.height * f.channels());
    read_pass(kWhole[0], rows_.get(), [&](int, const std::vector<float>& line) {
      values.insert(values.end(), line.begin(), line.end());
    });
    return Image(f.width, f.height, f.channels(), std::move(values));
  }

  Image interlaced_picture() {
    Image picture(format().width, format().height, format().channels());
    const int channels = picture.channels();
    Byte* rows = rows_.get();
    for (const Pass& pass : kAdam7) {
      if (pass.bytes(format()) == 0) continue;
      read_pass(pass, rows, [&](int y, const std::vector<float>& line) {
        const float* from = line.data();
        for (int x = pass.x; x < picture.width(); x += pass.step_x, from += channels)
          std::copy_n(from, channels, picture.pixel(x, pass.y + y * pass.step_y));
      });
      rows += pass.bytes(format());
    }
    return picture;
  }

  // take(y, line): the values of the pass's y-th row.
  template <class F>
  void read_pass(const Pass& pass, Byte* rows, F&& take) {
    const PngFormat& f = format();
    const int width = pass.width(f);
    std::vector<float> line(static_cast<std::size_t>(width) * f.channels());
    const auto take_row = [&](int y, const Byte* row) {
      line_values(row, line);
      take(y, line);
    };
    check(
        png::undo_filters(f.unit_bytes(), rows, f.row_bytes(width), pass.height(f), take_row),
        "a row has an unknown filter"
    );
  }

  void line_values(const Byte* row, std::vector<float>& line) const {
    stored_values(row, line);
    const bool has_alpha = format().samples() > format().channels() || !parts_.transparency.empty();
    if (background_ && has_alpha) compose(row, line);
  }

  // Without alpha.
  void stored_values(const Byte* row, std::vector<float>& line) const {
    const PngFormat& f = format();
    if (f.type == kPalette) return palette_values(row, line);
    const int range = (1 << f.depth) - 1, kept = f.channels(), stored = f.samples();
    if (f.depth == 8 && stored == kept) {
      for (std::size_t i = 0; i < line.size(); ++i) line[i] = detail::unit_value(row[i], range);
      return;
    }
    for (std::size_t i = 0; i < line.size(); ++i) {
      const std::size_t at = i / kept * stored + i % kept;  // without alpha, which is last
      line[i] = detail::unit_value(sample(row, at), range);
    }
  }

  // Colours of a PNG are straight: not multiplied by their alpha.
  void compose(const Byte* row, std::vector<float>& line) const {
    const std::size_t kept = format().channels();
    for (std::size_t i = 0; i < line.size(); ++i) {
      const float alpha = alpha_of(row, i / kept);
      line[i] = alpha * line[i] + (1 - alpha) * *background_;
    }
  }

  float alpha_of(const Byte* row, std::size_t pixel) const {
    const PngFormat& f = format();
    const std::size_t stored = f.samples(), kept = f.channels();
    if (f.type == kPalette) {
      const auto entry = static_cast<std::size_t>(sample(row, pixel));
      const std::string_view alphas = parts_.transparency;
      return entry < alphas.size() ? detail::unit_value(static_cast<Byte>(alphas[entry]), 255) : 1;
    }
    if (stored > kept)
      return detail::unit_value(sample(row, pixel * stored + kept), (1 << f.depth) - 1);
    for (std::size_t c = 0; c < kept; ++c)  // the colour that counts as transparent, or not
      if (sample(row, pixel * stored + c) != colorless(c)) return 1;
    return 0;
  }

  // Of tRNS: two bytes a sample. A chunk that is too short names none.
  int colorless(std::size_t channel) const {
    const std::string_view bytes =
        parts_.transparency.substr(std::min(2 * channel, parts_.transparency.size()), 2);
    return bytes.size() < 2 ? -1 : static_cast<int>(big_endian(bytes));
  }

  int sample(const Byte* row, std::size_t i) const {
    const int depth = format().depth;
    if (depth == 8) return row[i];
    if (depth == 16) return row[2 * i] << 8 | row[2 * i + 1];
    const int per_byte = 8 / depth, shift = 8 - depth * (1 + static_cast<int>(i % per_byte));
    return row[i / per_byte] >> shift & ((1 << depth) - 1);
  }

  void palette_values(const Byte* row, std::vector<float>& line) const {
    for (std::size_t pixel = 0; 3 * pixel < line.size(); ++pixel) {
      const auto entry = static_cast<std::size_t>(sample(row, pixel));
      check(3 * entry + 3 <= parts_.palette.size(), "a pixel has a colour beyond its palette");
      for (std::size_t c = 0; c < 3; ++c)
        line[3 * pixel + c] =
            detail::unit_value(static_cast<Byte>(parts_.palette[3 * entry + c]), 255);
    }
  }

  const fs::path& path_;
  std::optional<float> background_;  // none: alpha is dropped
  PngParts parts_;
  std::unique_ptr<Byte[]> rows_;
};

}  // namespace

detail::ClaimedSize detail::png_size(const fs::path& path, std::string_view file) {
  const std::string_view header = chunks_of(path, file).front().data();
  return {big_endian(header.substr(0, 4)), big_endian(header.substr(4, 4)), 4};
}

Image detail::decode_png(
    const fs::path& path, std::string_view file, std::optional<float> background
) {
  return PngReader(path, background).read(file);
}

}  // namespace glint
