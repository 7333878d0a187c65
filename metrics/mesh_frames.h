// SPDX-License-Identifier: MIT
// Meshes that are right but for their unit or their axes: the words for what distances alone do not
// tell.
#pragma once

#include <span>
#include <string>

#include "glint/core/gltf_axes.h"

namespace glint {

struct NamedCorners {
  fs::path path;
  std::span<const Vec3f> corners;  // what is not finite does not count
};

// Of so different a size that one is likely in another unit; empty: they are alike.
std::string mesh_unit_doubt(const NamedCorners& prediction, const NamedCorners& reference);

// A glTF that lies far better on the other mesh when it is turned back from y up to z up, by the
// boxes around both. Empty: it does not, it is no glTF, or `up` says that it has been turned.
std::string gltf_up_doubt(const NamedCorners& mesh, const NamedCorners& other, GltfUp up);

}  // namespace glint
