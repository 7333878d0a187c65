// SPDX-License-Identifier: MIT
// PLY as a container: header, then rows of scalars and lists, ASCII or binary of either order.
// ply.h gives the rows their meaning.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/files.h"

namespace glint::detail {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  // of a list
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;  // rows
  std::vector<PlyProperty> properties;
  std::vector<float> scalars;  // [count][num_scalars], in the order of the properties
  std::size_t num_scalars = 0;
  std::vector<std::int64_t> list_items;  // all rows of one list property, concatenated: that of
                                         // vertices where there are several
  std::vector<std::size_t> list_ends;    // [count] end of each row in list_items

  // Column of a scalar property, or -1.
  int find_scalar(std::string_view property) const;
  float scalar(std::size_t row, int column) const {
    return scalars[row * num_scalars + static_cast<std::size_t>(column)];
  }
};

struct PlyFile {
  std::string path;
  std::vector<PlyElement> elements;
  // Errors (kBadReference): no such element.
  const PlyElement& element(std::string_view name) const;
};

// Errors (kBadReference): no PLY, unknown types, counts that the file cannot hold, rows missing,
// unreadable numbers.
PlyFile read_ply(const fs::path& path);
// Of the header alone, with its errors.
std::vector<std::string> read_ply_element_names(const fs::path& path);

}  // namespace glint::detail
