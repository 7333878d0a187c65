// SPDX-License-Identifier: MIT
// MAT files of level 5, byte by byte as SciPy's savemat writes them, with and without compression.
#pragma once

#include <libdeflate.h>

#include <string>
#include <utility>
#include <vector>

namespace glint::test {

inline std::string little(std::uint32_t value, std::size_t bytes = 4) {
  std::string text;
  for (std::size_t i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i & 0xff);
  return text;
}

// A tag and its data; up to four bytes in the tag itself.
inline std::string mat_element(
    std::uint32_t kind, const std::string& data, bool may_be_small = true
) {
  const auto size = static_cast<std::uint32_t>(data.size());
  if (may_be_small && size > 0 && size <= 4)
    return little(kind | size << 16) + data + std::string(4 - size, '\0');
  return little(kind) + little(size) + data + std::string((8 - size % 8) % 8, '\0');
}

inline std::string mat_head(
    std::uint32_t kind, const std::string& name, const std::string& extents
) {
  return mat_element(6, little(kind) + little(0)) + mat_element(5, extents) + mat_element(1, name);
}

// `values` by columns.
inline std::string mat_array(
    const std::string& name,
    std::uint32_t rows,
    std::uint32_t columns,
    const std::vector<double>& values
) {
  const std::string bytes(
      reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)
  );
  return mat_element(
      14, mat_head(6, name, little(rows) + little(columns)) + mat_element(9, bytes), false
  );
}

// Of one element, fields in their order.
inline std::string mat_struct(
    const std::string& name, const std::vector<std::pair<std::string, std::string>>& fields
) {
  constexpr std::size_t kLength = 32;
  std::string names, values;
  for (const auto& [field, value] : fields) {
    names += field + std::string(kLength - field.size(), '\0');
    values += value;
  }
  return mat_element(
      14,
      mat_head(2, name, little(1) + little(1)) + mat_element(5, little(kLength)) +
          mat_element(1, names) + values,
      false
  );
}

inline std::string mat_compressed(const std::string& matrix) {
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(6);
  std::string packed(libdeflate_zlib_compress_bound(compressor, matrix.size()), '\0');
  packed.resize(libdeflate_zlib_compress(
      compressor, matrix.data(), matrix.size(), packed.data(), packed.size()
  ));
  libdeflate_free_compressor(compressor);
  return little(15) + little(static_cast<std::uint32_t>(packed.size())) + packed;
}

inline std::string mat_file(const std::vector<std::string>& matrices) {
  std::string file = "MATLAB 5.0 MAT-file";
  file.resize(124, ' ');
  file += little(0x0100, 2) + "IM";
  for (const std::string& matrix : matrices) file += matrix;
  return file;
}

}  // namespace glint::test
