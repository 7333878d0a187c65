// SPDX-License-Identifier: MIT
#include "glint/scene/image_files_stored.h"

#include <string>
#include <string_view>

#include "glint/core/npy.h"
#include "glint/core/presence.h"

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

bool has_alpha(const fs::path& path) {
  constexpr std::size_t kColorType =
      25;  // after the signature, IHDR's length and name, sizes, depth
  const std::string file = beginning_of(path, kColorType + 1);
  const bool is_png = file.starts_with("\x89PNG") && file.size() > kColorType;
  return is_png && (file[kColorType] == 4 || file[kColorType] == 6);
}

}  // namespace glint
