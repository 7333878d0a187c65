// SPDX-License-Identifier: MIT
// The header of an EXR file, looked at before OpenEXR allocates what it says: kinds of files that
// hold no plain picture, and sizes that the file cannot fill.
#include <algorithm>
#include <cstring>

#include "glint/core/error.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

constexpr std::uint32_t kMagic = 20000630;
constexpr std::uint32_t kDeepFlag = 1u << 11, kPartsFlag = 1u << 12;
constexpr std::int64_t kMostLines = 256;  // of a compressed block, which is unpacked at once

// Little-endian values and texts from the front of the bytes.
class HeaderSource {
 public:
  HeaderSource(const fs::path& path, std::string_view bytes) : path_(path), bytes_(bytes) {}

  template <class T>
  T number() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string_view text() {
    const std::size_t length = bytes_.find('\0');
    if (length == std::string_view::npos) fail("it ends inside the header");
    const std::string_view text = take(length);
    take(1);
    return text;
  }
  std::string_view take(std::size_t count) {
    if (count > bytes_.size())
      fail(fmt::format("an attribute of {} bytes in front of {}", count, bytes_.size()));
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  bool ends_here() const { return !bytes_.empty() && bytes_.front() == '\0'; }
  bool empty() const { return bytes_.empty(); }
  [[noreturn]] void fail(const std::string& why) const {
    detail::fail_incomplete(path_, "EXR", why);
  }

 private:
  const fs::path& path_;
  std::string_view bytes_;
};

// OpenEXR reads as many bytes as values of these types have, whatever the attribute says: with
// another size it would take the rest of the header for something else.
struct TypeBytes {
  std::string_view type;
  std::uint32_t bytes;
};
constexpr TypeBytes kTypeBytes[] = {{"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
                                    {"compression", 1}, {"double", 8},   {"envmap", 1},
                                    {"float", 4},       {"int", 4},      {"keycode", 28},
                                    {"lineOrder", 1},   {"m33d", 72},    {"m33f", 36},
                                    {"m44d", 128},      {"m44f", 64},    {"rational", 8},
                                    {"tiledesc", 9},    {"timecode", 8}, {"v2d", 16},
                                    {"v2f", 8},         {"v2i", 8},      {"v3d", 24},
                                    {"v3f", 12},        {"v3i", 12},     {"deepImageState", 1}};

// Channels of a list: name, then 16 bytes of type and sampling; an empty name ends it.
std::int64_t count_channels(HeaderSource list) {
  std::int64_t count = 0;
  for (; !list.ends_here(); ++count) {
    list.text();
    list.take(16);
  }
  list.take(1);
  if (!list.empty()) list.fail("bytes behind the last channel");
  return count;
}

bool fits_strings(HeaderSource strings) {
  while (!strings.empty()) strings.take(strings.number<std::uint32_t>());
  return true;
}

bool fits_preview(HeaderSource preview, std::uint64_t bytes) {
  const std::uint64_t width = preview.number<std::uint32_t>();
  const std::uint64_t height = preview.number<std::uint32_t>();
  return width < 65536 && height < 65536 && 8 + 4 * width * height == bytes;
}

void check_attribute(std::string_view type, HeaderSource value, std::uint32_t bytes) {
  const auto* fixed =
      std::find_if(std::begin(kTypeBytes), std::end(kTypeBytes), [&](const TypeBytes& t) {
        return t.type == type;
      });
  const bool fits = fixed != std::end(kTypeBytes) ? fixed->bytes == bytes
                    : type == "stringvector"      ? fits_strings(value)
                    : type == "preview"           ? fits_preview(value, bytes)
                    : type == "idmanifest"        ? bytes >= 4
                    : type == "chlist"            ? count_channels(value) >= 0
                                                  : true;
  if (!fits) value.fail(fmt::format("an attribute of type {} with {} bytes", type, bytes));
}

}  // namespace

void detail::check_exr_header(const fs::path& path, std::string_view file) {
  HeaderSource source(path, file);
  if (file.size() < 8 || source.number<std::uint32_t>() != kMagic)
    source.fail("the signature is missing");
  const auto version = source.number<std::uint32_t>();
  GLINT_CHECK(
      (version & (kDeepFlag | kPartsFlag)) == 0,
      kBadReference,
      "{}: a {} EXR; save one flat picture (scan lines, one part)",
      path.string(),
      (version & kDeepFlag) != 0 ? "deep" : "multi-part"
  );
  ClaimedSize size;
  while (!source.ends_here()) {
    const std::string_view name = source.text(), type = source.text();
    const auto bytes = source.number<std::uint32_t>();
    HeaderSource value(path, source.take(bytes));
    check_attribute(type, value, bytes);
    if (name == "channels" && type == "chlist") {
      size.channels = count_channels(value);
    } else if (name == "dataWindow" && type == "box2i") {
      const std::int64_t left = value.number<std::int32_t>(), top = value.number<std::int32_t>();
      const std::int64_t right = value.number<std::int32_t>();
      size.width = std::max(size.width, right - left + 1);
      size.height = std::max(size.height, value.number<std::int32_t>() - top + 1);
    } else if (name == "tiles" && type == "tiledesc") {
      const std::int64_t width = value.number<std::uint32_t>();
      size.width = std::max(size.width, width);
      size.height = std::max(size.height, std::int64_t{value.number<std::uint32_t>()});
    }
  }
  if (size.channels == 0 || size.width <= 0) source.fail("the header has no channels or no size");
  size.height = std::max(size.height, kMostLines);
  check_claimed_size(path, size, file.size());
}

}  // namespace glint
