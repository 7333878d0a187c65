// SPDX-License-Identifier: MIT
// MATLAB's MAT files of level 5, as SciPy's savemat writes them: numeric arrays and structs of
// such. (libmatio would bring HDF5 for what a scene needs two small matrices of.)
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

struct MatValue {
  std::vector<std::size_t> extents;  // of an array, at least two
  std::vector<double> values;        // by columns; empty: of a struct, or of what is no number
  std::map<std::string, MatValue> fields;  // of a struct's first element
};

// By name. Errors (kBadReference): another format (MAT 7.3 is HDF5), cut off, sizes that do not
// fit, nested more than 8 deep.
std::map<std::string, MatValue> read_mat(const fs::path& path);

}  // namespace glint
