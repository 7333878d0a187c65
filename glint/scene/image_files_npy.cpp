// SPDX-License-Identifier: MIT
// NumPy arrays [H][W] or [H][W][C]; as PyTorch has them, [C][H][W] and with leading axes of one.
#include <ImathConfig.h>
#include <half.h>

#include <algorithm>
#include <array>
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
  float (*read)(const char*);  // of little-endian bytes
};
constexpr ValueType kValueTypes[] = {
    {"f4", 4, convert<float>},
    {"f8", 8, convert<double>},
    {"f2", 2, convert<half>},
    {"u1", 1, convert<std::uint8_t>},
    {"u2", 2, convert<std::uint16_t>},
    {"b1", 1, [](const char* from) { return *from != 0 ? 1.0f : 0.0f; }},
};

const ValueType& find_type(const fs::path& path, const std::string& name) {
  const auto* type =
      std::find_if(std::begin(kValueTypes), std::end(kValueTypes), [&](const ValueType& t) {
        return !name.empty() && "<>|="sv.find(name[0]) != std::string_view::npos &&
               name.substr(1) == t.name;
      });
  GLINT_CHECK(
      type != std::end(kValueTypes),
      kBadReference,
      "{}: values of type '{}'; expected float16, float32, float64, uint8, uint16 or bool",
      path.string(),
      name
  );
  return *type;
}

bool is_channel_count(std::int64_t n) { return n == 1 || n == 3 || n == 4; }

// An axis of the array, as it lies in the file.
struct Axis {
  std::int64_t extent = 1;
  std::size_t step = 0;  // values from one to the next
};

// In C order the last index is the fastest, in Fortran order the first.
std::vector<Axis> axes_of(const NpyHeader& header) {
  std::vector<Axis> axes;
  for (const std::int64_t extent : header.shape) axes.push_back({extent});
  std::size_t step = 1;
  const auto take = [&](Axis& axis) {
    axis.step = step;
    step *= static_cast<std::size_t>(axis.extent);
  };
  if (header.fortran_order)
    std::for_each(axes.begin(), axes.end(), take);
  else
    std::for_each(axes.rbegin(), axes.rend(), take);
  return axes;
}

struct ArrayLayout {
  Axis height, width, channels;

  std::size_t at(std::size_t y, std::size_t x, std::size_t channel) const {
    return y * height.step + x * width.step + channel * channels.step;
  }
};

// Two channels are no picture's: grey with alpha, say, or flow.
ArrayLayout layout_of(const fs::path& path, const NpyHeader& header) {
  std::vector<Axis> axes = axes_of(header);
  while (axes.size() > 3 && axes.front().extent == 1) axes.erase(axes.begin());  // a batch of one
  if (axes.size() == 2) return {axes[0], axes[1], {}};
  if (axes.size() == 3 && is_channel_count(axes[2].extent)) return {axes[0], axes[1], axes[2]};
  if (axes.size() == 3 && is_channel_count(axes[0].extent)) return {axes[1], axes[2], axes[0]};
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: shape ({}); expected (height, width), (height, width, channels) or (channels, "
          "height, width), with 1, 3 or 4 channels",
          path.string(),
          fmt::join(header.shape, ", ")
      )
  );
}

}  // namespace

Image detail::read_npy(const fs::path& path) {
  const std::string file = read_file(path);
  const NpyHeader header = parse_npy_header(file, path.string());
  const ValueType& type = find_type(path, header.type);
  const ArrayLayout layout = layout_of(path, header);
  const auto stored = static_cast<std::size_t>(layout.channels.extent);
  check_claimed_size(
      path, {layout.width.extent, layout.height.extent, layout.channels.extent}, file.size()
  );
  const std::size_t kept = std::min<std::size_t>(stored, 3);  // alpha is dropped
  Image image(
      static_cast<int>(layout.width.extent),
      static_cast<int>(layout.height.extent),
      static_cast<int>(kept)
  );
  const std::size_t expected = image.num_pixels() * stored * type.bytes;
  if (file.size() - header.values_at != expected)
    fail_incomplete(
        path,
        "NPY",
        fmt::format("{} bytes of values, expected {}", file.size() - header.values_at, expected)
    );
  const char* from = file.data() + header.values_at;
  const bool big_endian = header.type[0] == '>';
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      for (std::size_t c = 0; c < kept; ++c) {
        std::array<char, 8> value{};
        const std::size_t at =
            layout.at(static_cast<std::size_t>(y), static_cast<std::size_t>(x), c);
        std::copy_n(from + at * type.bytes, type.bytes, value.begin());
        if (big_endian)
          std::reverse_copy(from + at * type.bytes, from + (at + 1) * type.bytes, value.begin());
        image.at(x, y, static_cast<int>(c)) = type.read(value.data());
      }
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
