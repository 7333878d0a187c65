// SPDX-License-Identifier: MIT
// NumPy arrays [H][W] or [H][W][C].
#include <ImathConfig.h>
#include <half.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/npy.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

using namespace std::string_view_literals;

template <class T>
float convert(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  if constexpr (std::is_integral_v<T>)
    return static_cast<float>(value) / static_cast<float>(std::numeric_limits<T>::max());
  else
    return static_cast<float>(value);
}

struct ValueType {
  const char* name;
  std::size_t bytes;
  float (*read)(const char*);
};
constexpr ValueType kValueTypes[] = {
    {"<f4", 4, convert<float>},
    {"<f8", 8, convert<double>},
    {"<f2", 2, convert<half>},
    {"|u1", 1, convert<std::uint8_t>},
    {"<u2", 2, convert<std::uint16_t>},
    {"|b1", 1, [](const char* from) { return *from != 0 ? 1.0f : 0.0f; }},
};

const ValueType& find_type(const fs::path& path, const std::string& name) {
  const auto* type =
      std::find_if(std::begin(kValueTypes), std::end(kValueTypes), [&](const ValueType& t) {
        return t.name == name;
      });
  GLINT_CHECK(
      type != std::end(kValueTypes),
      kBadReference,
      "{}: values of type '{}'; expected float16, float32, float64, uint8, uint16 or bool, "
      "little-endian",
      path.string(),
      name
  );
  return *type;
}

detail::ClaimedSize image_size(const fs::path& path, const NpyHeader& header) {
  const std::vector<std::int64_t>& shape = header.shape;
  // Two channels are no picture's: grey with alpha, say, or flow.
  const bool usable =
      shape.size() == 2 || (shape.size() == 3 && shape[2] >= 1 && shape[2] <= 4 && shape[2] != 2);
  GLINT_CHECK(
      usable,
      kBadReference,
      "{}: shape ({}); expected (height, width) or (height, width, channels) with 1, 3 or 4 "
      "channels",
      path.string(),
      fmt::join(shape, ", ")
  );
  return {shape[1], shape[0], shape.size() == 3 ? shape[2] : 1};
}

// Where the value of a pixel's channel stands among all: with the last index fastest, or, in
// Fortran order, the first.
struct ValueOrder {
  std::size_t width, height, channels;
  bool fortran;

  std::size_t at(std::size_t pixel, std::size_t channel) const {
    if (!fortran) return pixel * channels + channel;
    return pixel / width + height * (pixel % width + width * channel);
  }
};

}  // namespace

Image detail::read_npy(const fs::path& path) {
  const std::string file = read_file(path);
  const NpyHeader header = parse_npy_header(file, path.string());
  const ValueType& type = find_type(path, header.type);
  const ClaimedSize size = image_size(path, header);
  check_claimed_size(path, size, file.size());
  const auto stored = static_cast<std::size_t>(size.channels);
  const std::size_t kept = std::min<std::size_t>(stored, 3);  // alpha is dropped
  Image image(static_cast<int>(size.width), static_cast<int>(size.height), static_cast<int>(kept));
  const std::size_t expected = image.num_pixels() * stored * type.bytes;
  if (file.size() - header.values_at != expected)
    fail_incomplete(
        path,
        "NPY",
        fmt::format("{} bytes of values, expected {}", file.size() - header.values_at, expected)
    );
  const char* from = file.data() + header.values_at;
  const ValueOrder order{
      static_cast<std::size_t>(size.width),
      static_cast<std::size_t>(size.height),
      stored,
      header.fortran_order};
  for (std::size_t i = 0; i < image.num_pixels(); ++i)
    for (std::size_t c = 0; c < kept; ++c)
      image.data()[i * kept + c] = type.read(from + order.at(i, c) * type.bytes);
  return image;
}

void write_npy(const fs::path& path, ImageView image) {
  const std::string shape =
      image.channels == 1 ? fmt::format("{}, {}", image.height, image.width)
                          : fmt::format("{}, {}, {}", image.height, image.width, image.channels);
  std::string dictionary =
      fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}), }}", shape);
  // Values start at a multiple of 64 bytes; the header ends in a newline.
  const std::size_t preamble = kNpyMagic.size() + 4;
  dictionary.resize((preamble + dictionary.size() + 1 + 63) / 64 * 64 - preamble - 1, ' ');
  dictionary += '\n';
  std::string file(kNpyMagic);
  file += "\x01\x00"sv;
  file += static_cast<char>(dictionary.size() & 0xff);
  file += static_cast<char>(dictionary.size() >> 8);
  file += dictionary;
  const std::size_t values = image.num_pixels() * static_cast<std::size_t>(image.channels);
  file.append(reinterpret_cast<const char*>(image.data), values * sizeof(float));
  write_file(path, file);
}

}  // namespace glint
