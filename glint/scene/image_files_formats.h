// SPDX-License-Identifier: MIT
// One reader and writer per image file format, behind image_files.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/image.h"

namespace glint::detail {

// PNG, JPEG, WebP or BMP, by its first bytes. `background`: what pixels of a picture with alpha are
// laid on; without it, alpha is dropped.
Image read_picture(const fs::path& path, std::optional<float> background = {});
Image read_exr(const fs::path& path);
Image read_npy(const fs::path& path);

Image repeat_grey(const Image& grey, int channels);

// What a file's header claims about the picture inside.
struct ClaimedSize {
  std::int64_t width = 0, height = 0, channels = 0;
};

// What a PNG claims, after checking that all its chunks are there. Errors (kBadReference).
ClaimedSize png_size(const fs::path& path, std::string_view file);
ClaimedSize webp_size(const fs::path& path, std::string_view file);
ClaimedSize bmp_size(const fs::path& path, std::string_view file);

// The codecs, of files whose claimed size was checked. Integers divided by their maximum, 1 (grey)
// or 3 channels (R G B); alpha is dropped, or laid on `background`. Errors (kBadReference):
// damaged, or colours that are not read; `path` opens the message.
Image decode_png(const fs::path& path, std::string_view file, std::optional<float> background = {});
Image decode_jpeg(const fs::path& path, const std::string& file);
Image decode_webp(
    const fs::path& path, std::string_view file, std::optional<float> background = {}
);
Image decode_bmp(const fs::path& path, std::string_view file);

// Of PNG and JPEG headers; at most four bytes.
inline std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char c : bytes) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

inline bool is_webp(std::string_view file) {
  return file.starts_with("RIFF") && file.substr(0, 12).ends_with("WEBP");
}

// Of an EXR. Errors (kBadReference): deep, in parts, or with sizes that the file cannot fill.
void check_exr_header(const fs::path& path, std::string_view file);

// What the integers 0 ... full_range of a file stand for.
inline float unit_value(int n, int full_range) {
  return static_cast<float>(n) / static_cast<float>(full_range);
}
// The file. 1 or 3 channels, full range.
std::string encode_png(MaskView image);
// One channel of 16 bits, [H][W].
std::string encode_png16(ImageSize size, const std::uint16_t* grey);

// Throws (kBadReference) unless a picture of that size can come out of `file_bytes` bytes: no
// header makes us allocate more than 256 MiB that the file cannot fill.
void check_claimed_size(const fs::path& path, ClaimedSize size, std::size_t file_bytes);

// Throws (kBadReference) "path: not a complete <format> file (<detail>); ...".
[[noreturn]] void fail_incomplete(
    const fs::path& path, std::string_view format, std::string_view detail
);

}  // namespace glint::detail
