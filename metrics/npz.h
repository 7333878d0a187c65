// SPDX-License-Identifier: MIT
// NumPy's .npz: a zip of .npy files, here of float32 arrays in C order.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

struct NpzArray {
  std::vector<std::int64_t> shape;
  std::vector<float> values;
};
using NpzArrays = std::map<std::string, NpzArray>;  // by name, without ".npy"

// At most 1 GiB of arrays. Errors (kBadReference): no file, not a zip or a damaged one, an entry
// that is no array of float32, whose shape does not fit its bytes, or that comes twice.
NpzArrays read_npz(const fs::path& path);

}  // namespace glint
