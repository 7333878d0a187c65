// SPDX-License-Identifier: MIT
// The tag Orientation (274) of EXIF, which is a TIFF without a picture: in JPEG a segment APP1, in
// PNG a chunk eXIf, in TIFF the file itself. Only headers are read: photos are large.
#include <optional>
#include <string>
#include <string_view>

#include "glint/core/presence.h"
#include "glint/scene/image_files_formats.h"
#include "glint/scene/image_files_stored.h"

namespace glint {
namespace {

using namespace std::string_view_literals;
using detail::big_endian;

// Bytes of a file at any place; fewer, or none, where it ends before.
class Bytes {
 public:
  explicit Bytes(std::istream& in) : in_(in) {}

  std::string at(std::uint64_t place, std::size_t count) {
    constexpr std::uint64_t kFarthest = 1ull << 40;
    if (place > kFarthest) return {};
    std::string bytes(count, '\0');
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(place));
    in_.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(in_.gcount()));
    return bytes;
  }

 private:
  std::istream& in_;
};

// A number of a TIFF, whose first letters say in which order its bytes are.
std::uint32_t number(std::string bytes, bool big) {
  if (!big) bytes.assign(bytes.rbegin(), bytes.rend());
  return big_endian(bytes);
}

// Of the TIFF that begins at `base`: its first directory has twelve bytes an entry.
std::optional<int> in_tiff(Bytes& file, std::uint64_t base) {
  constexpr std::size_t kEntry = 12;
  constexpr std::uint32_t kOrientation = 274, kShort = 3;
  const std::string head = file.at(base, 8);
  const bool big = head.starts_with("MM\0*"sv);
  if (head.size() < 8 || !(big || head.starts_with("II*\0"sv))) return {};
  const std::uint64_t directory = base + number(head.substr(4), big);
  const std::string count = file.at(directory, 2);
  if (count.size() < 2) return {};
  const std::string entries = file.at(directory + 2, kEntry * number(count, big));
  for (std::size_t at = 0; at + kEntry <= entries.size(); at += kEntry)
    if (number(entries.substr(at, 2), big) == kOrientation &&
        number(entries.substr(at + 2, 2), big) == kShort)
      return static_cast<int>(number(entries.substr(at + 8, 2), big));
  return {};
}

std::optional<int> in_jpeg(Bytes& file) {
  constexpr unsigned char kExif = 0xe1, kScan = 0xda;  // APP1; SOS: the picture itself follows
  for (std::uint64_t at = 2;;) {
    const std::string segment = file.at(at, 10);
    if (segment.size() < 10 || segment[0] != '\xff') return {};
    const auto marker = static_cast<unsigned char>(segment[1]);
    if (marker == kScan) return {};
    if (marker == kExif && segment.substr(4) == "Exif\0\0"sv) return in_tiff(file, at + 10);
    at += marker == 0xff ? 1 : 2 + big_endian(segment.substr(2, 2));
  }
}

std::optional<int> in_png(Bytes& file) {
  constexpr std::uint64_t kSignature = 8, kOverhead = 12;  // length, type, checksum
  for (std::uint64_t at = kSignature;;) {
    const std::string chunk = file.at(at, 8);
    if (chunk.size() < 8) return {};
    if (chunk.substr(4) == "eXIf") return in_tiff(file, at + 8);
    at += kOverhead + big_endian(chunk.substr(0, 4));
  }
}

}  // namespace

int stated_orientation(const fs::path& path) {
  auto in = open_file(path);
  Bytes file(in);
  const std::string head = file.at(0, 4);
  std::optional<int> stated;
  if (head.starts_with("\xff\xd8"sv)) stated = in_jpeg(file);
  if (head.starts_with("\x89PNG"sv)) stated = in_png(file);
  if (head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv)) stated = in_tiff(file, 0);
  return stated && *stated >= 2 && *stated <= 8 ? *stated : 1;
}

std::string orientation_words(int orientation) {
  constexpr std::string_view kShown[] = {
      "as stored",
      "mirrored left to right",
      "turned by 180 degrees",
      "mirrored top to bottom",
      "mirrored, then turned by 90 degrees counter-clockwise",
      "turned by 90 degrees clockwise",
      "mirrored, then turned by 90 degrees clockwise",
      "turned by 90 degrees counter-clockwise"};
  return fmt::format(
      "EXIF orientation {} (to be shown {})",
      orientation,
      kShown[static_cast<std::size_t>(orientation - 1)]
  );
}

std::string orientation_hint(const fs::path& path) {
  const int orientation = stated_orientation(path);
  if (orientation == 1) return {};
  return fmt::format(
      "; {} states {}, and pixels are taken as stored: this is the likely cause; turn the pixels "
      "themselves and drop the tag (mogrify -auto-orient)",
      path.filename().string(),
      orientation_words(orientation)
  );
}

}  // namespace glint
