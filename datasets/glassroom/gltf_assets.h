// SPDX-License-Identifier: MIT
// Furniture from glTF files (assimp). A file replaces the procedural pieces of the kind that its
// name contains: sofa, armchair, bookshelf, cabinet, table, desk, stool, plant, lamp, wardrobe.
#pragma once

#include <string>

#include "datasets/glassroom/room.h"
#include "glint/core/files.h"

namespace glint {

// Source of all usable .gltf and .glb files of a folder, in natural order of names; one file a
// kind. Files of no known kind are skipped with a message. Errors (kBadReference): the folder or a
// file cannot be read, a file has no triangles; (when called) a texture cannot be read.
AssetSource gltf_assets(const fs::path& folder);

// Hash of the names and bytes of everything in the folder: part of the cache key.
std::string asset_hash(const fs::path& folder);

}  // namespace glint
