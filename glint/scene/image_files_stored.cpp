// SPDX-License-Identifier: MIT
#include "glint/scene/image_files_stored.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "glint/core/npy.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

constexpr std::size_t kBeginning = 10 + 65535;  // bytes: the longest header of NPY's format 1

std::string beginning_of(const fs::path& path, std::size_t count = kBeginning) {
  std::string bytes(count, '\0');
  std::ifstream in = open_file(path);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

// "<u2", "|b1": the letter says the kind.
bool is_integer_type(std::string_view npy_type) {
  return npy_type.find_first_of("uib") != std::string_view::npos;
}

}  // namespace

bool stores_integers(const fs::path& path) {
  const std::string file = beginning_of(path);
  if (file.starts_with(kNpyMagic))
    return is_integer_type(parse_npy_header(file, path.string()).type);
  if (file.starts_with("II") || file.starts_with("MM")) return tiff_stores_integers(path);
  return file.starts_with("\x89PNG") || file.starts_with("\xff\xd8");  // or JPEG; else EXR
}

bool is_jpeg(const fs::path& path) { return is_file(path) && beginning_of(path, 2) == "\xff\xd8"; }

bool has_alpha(const fs::path& path) {
  constexpr std::size_t kColorType =
      25;  // after the signature, IHDR's length and name, sizes, depth
  const std::string file = beginning_of(path, kColorType + 1);
  const bool is_png = file.starts_with("\x89PNG") && file.size() > kColorType;
  return is_png && (file[kColorType] == 4 || file[kColorType] == 6);
}

Image read_composed(const fs::path& path, int channels, float background) {
  if (!has_alpha(path)) return read_image(path, channels);
  Image image =
      read_within_memory(path, [&] { return detail::read_png_or_jpeg(path, background); });
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
