// SPDX-License-Identifier: MIT
// glTF has y up. Programs whose frames have z up turn what they write: (x, y, z) to (x, z, -y).
#pragma once

#include "glint/core/files.h"
#include "glint/core/vec.h"

namespace glint {

enum class GltfUp { kY, kZ };  // which axis was up before

inline bool is_gltf(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".glb" || extension == ".gltf" || extension == ".GLB";
}
inline Vec3f turned_back(Vec3f v) { return {v.x, -v.z, v.y}; }

}  // namespace glint
