// SPDX-License-Identifier: MIT
// The header of NumPy's array files, format 1 to 3 of numpy.lib.format: magic, version, length of a
// Python dictionary, the dictionary, the values.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

inline constexpr std::string_view kNpyMagic{"\x93NUMPY", 6};

struct NpyHeader {
  std::string type;  // e.g. "<f4"
  std::vector<std::int64_t> shape;
  bool fortran_order = false;
  std::size_t values_at = 0;  // bytes from the beginning, at most the size of the file
};

// `file`: the whole file; `where` opens messages. Errors (kBadReference): not such a file, cut off
// inside the header, a key missing. Extents that fit no integer come back as the largest one.
NpyHeader parse_npy_header(std::string_view file, std::string_view where);

}  // namespace glint
