// SPDX-License-Identifier: MIT
// Whether a set's geometry is what it was in the call before.
#pragma once

#include <cstdint>

namespace glint::gpu {

// Of the arrays that splats and discs are made of (Array::device_revision()); 0: not known.
struct GeometryRevision {
  std::uint64_t means = 0, scales = 0, rotations = 0, opacities = 0;
  bool known() const { return means != 0 && scales != 0 && rotations != 0 && opacities != 0; }
  friend bool operator==(const GeometryRevision&, const GeometryRevision&) = default;
};

}  // namespace glint::gpu
