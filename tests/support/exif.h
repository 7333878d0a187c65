// SPDX-License-Identifier: MIT
// Pictures that state an orientation, as cameras and telephones write them.
#pragma once

#include <string>
#include <string_view>

namespace glint::test {

inline std::string number_bytes(unsigned value, int count, bool big) {
  std::string bytes;
  for (int i = 0; i < count; ++i)
    bytes += static_cast<char>(value >> 8 * (big ? count - 1 - i : i) & 0xff);
  return bytes;
}

// The TIFF of EXIF: a resolution and the orientation.
inline std::string exif(int orientation, bool big) {
  const auto entry = [&](unsigned tag, unsigned value) {
    return number_bytes(tag, 2, big) + number_bytes(3, 2, big) + number_bytes(1, 4, big) +
           number_bytes(value, 2, big) + number_bytes(0, 2, big);
  };
  return (big ? "MM" : "II") + number_bytes(42, 2, big) + number_bytes(8, 4, big) +
         number_bytes(2, 2, big) + entry(256, 7) + entry(274, static_cast<unsigned>(orientation)) +
         number_bytes(0, 4, big);
}

// The segment goes behind the marker that every JPEG begins with.
inline std::string jpeg_with_exif(std::string jpeg, int orientation, bool big) {
  const std::string data = std::string("Exif\0\0", 6) + exif(orientation, big);
  const auto length = static_cast<unsigned>(data.size() + 2);
  return jpeg.insert(2, "\xff\xe1" + number_bytes(length, 2, true) + data);
}

// The chunk goes behind the header; its checksum, of a chunk that may be left out, is not looked
// at.
inline std::string png_with_exif(std::string png, int orientation, bool big) {
  constexpr std::size_t kHeaderEnd = 8 + 12 + 13;
  const std::string data = exif(orientation, big);
  return png.insert(
      kHeaderEnd,
      number_bytes(static_cast<unsigned>(data.size()), 4, true) + "eXIf" + data + "\1\2\3\4"
  );
}

}  // namespace glint::test
