// SPDX-License-Identifier: MIT
#include "glint/scene/image_files_stored.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "glint/core/error.h"
#include "glint/core/npy.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

using detail::is_webp;

constexpr std::size_t kColorType =
    25;  // of PNG: after signature, IHDR's length and name, sizes, depth
constexpr std::size_t kBeginning = 10 + 65535;  // bytes: the longest header of NPY's format 1

std::string beginning_of(const fs::path& path, std::size_t count = kBeginning) {
  std::string bytes(count, '\0');
  std::ifstream in = open_file(path);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

// Of "<u2", "|b1": the letter says the kind, the number its bytes.
int range_of_type(std::string_view npy_type) {
  if (npy_type.find_first_of("b") != std::string_view::npos) return 1;
  if (npy_type.find_first_of("ui") == std::string_view::npos) return 0;
  return npy_type.ends_with("1") ? 255 : 65535;
}

// Of IHDR: samples of a palette have 8 bits.
int range_of_png(std::string_view file) {
  constexpr std::size_t kDepth = 24;
  if (file.size() <= kColorType) return 255;
  const int depth = file[kColorType] == 3 ? 8 : std::clamp<int>(file[kDepth], 1, 16);
  return (1 << depth) - 1;
}

bool is_tiff(std::string_view file) { return file.starts_with("II") || file.starts_with("MM"); }

// Of a file's beginning: a channel, or the chunk tRNS, which stands in front of the pixels; text
// that is longer than the beginning hides it.
bool png_has_alpha(std::string_view file) {
  constexpr std::size_t kSignature = 8, kOverhead = 12;  // length, type, checksum
  if (file.size() <= kColorType) return false;
  if (file[kColorType] == 4 || file[kColorType] == 6) return true;
  for (std::size_t at = kSignature; at + 8 <= file.size();) {
    const std::string_view type = file.substr(at + 4, 4);
    if (type == "tRNS" || type == "IDAT") return type == "tRNS";
    at += kOverhead + detail::big_endian(file.substr(at, 4));
  }
  return false;
}

// VP8X names it in a flag; lossless pictures without such a header, in theirs (RFC 9649).
bool webp_has_alpha(std::string_view file) {
  constexpr std::size_t kKind = 12, kFlags = 20, kLosslessBits = 24;
  if (file.size() <= kLosslessBits) return false;
  const std::string_view kind = file.substr(kKind, 4);
  if (kind == "VP8X") return (file[kFlags] & 0x10) != 0;
  return kind == "VP8L" && (file[kLosslessBits] & 0x10) != 0;
}

}  // namespace

bool stores_integers(const fs::path& path) { return integer_range(path) > 0; }

int integer_range(const fs::path& path) {
  const std::string file = beginning_of(path);
  if (file.starts_with(kNpyMagic)) return range_of_type(parse_npy_header(file, path.string()).type);
  if (is_tiff(file)) return tiff_integer_range(path);
  if (file.starts_with("\x89PNG")) return range_of_png(file);
  return file.starts_with("\xff\xd8") || is_webp(file) || file.starts_with("BM") ? 255
                                                                                 : 0;  // else EXR
}

bool is_colored_png(const fs::path& path) {
  constexpr int kColor = 2;  // a bit of the colour type
  const std::string file = beginning_of(path, kColorType + 1);
  return file.starts_with("\x89PNG") && file.size() > kColorType &&
         (file[kColorType] & kColor) != 0;
}

bool is_jpeg(const fs::path& path) { return is_file(path) && beginning_of(path, 2) == "\xff\xd8"; }

bool has_alpha(const fs::path& path) try {
  const std::string file = beginning_of(path);
  if (file.starts_with("\x89PNG")) return png_has_alpha(file);
  if (is_webp(file)) return webp_has_alpha(file);
  return is_tiff(file) && tiff_has_alpha.here() && tiff_has_alpha(path);
} catch (const Error&) {
  return false;  // what reads the picture has the message
}

Image read_composed(const fs::path& path, int channels, float background) {
  if (!has_alpha(path)) return read_image(path, channels);
  Image image = read_within_memory(path, [&] {
    return is_tiff(beginning_of(path, 4)) ? read_tiff(path, background)
                                          : detail::read_picture(path, background);
  });
  return image.channels() == channels ? image : detail::repeat_grey(image, channels);
}

Image read_alpha(const fs::path& path) {
  const Image on_black = read_composed(path, 3, 0), on_white = read_composed(path, 3, 1);
  Image alpha(on_black.width(), on_black.height(), 1);
  for (std::size_t i = 0; i < alpha.num_pixels(); ++i)
    alpha.data()[i] = 1 - (on_white.data()[3 * i] - on_black.data()[3 * i]);
  return alpha;
}

bool looks_premultiplied(const fs::path& path) {
  constexpr std::size_t kEnough = 200;  // pixels
  constexpr float kStep = 1 / 255.0f;
  if (!has_alpha(path)) return false;
  const Image alpha = read_alpha(path), color = read_image(path, 3);
  std::size_t count = 0;
  for (std::size_t i = 0; i < alpha.num_pixels(); ++i) {
    const float a = alpha.data()[i], *c = color.data() + 3 * i;
    if (std::max({c[0], c[1], c[2]}) > a + kStep) return false;
    if (a > 0.1f && a < 0.9f) ++count;
  }
  return count >= kEnough;
}

}  // namespace glint
