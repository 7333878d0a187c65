// SPDX-License-Identifier: MIT
// Models of others as triangles with materials and textures, through assimp: glTF 2.0 and OBJ.
#pragma once

#include "datasets/glassroom/furniture.h"
#include "glint/core/files.h"

namespace glint {

// The triangles of a .gltf, .glb or .obj in the file's own axes (mostly y up) and units, materials
// and textures added to the scene. Only diffuse colour and texture count: emission, gloss and
// transparency of such files are seldom meant. `texture`: a picture for all materials in place of
// their own. Errors (kBadReference): no such file, not of these formats, no triangles, vertices
// that are not finite, files of the model outside of its folder or not readable.
Furniture import_model(const fs::path& file, TraceScene& scene, const fs::path& texture = {});

// A picture as linear reflectance of at most 0.95, three channels, no side above 512 pixels.
// Errors: read_image()'s.
Image read_reflectance(const fs::path& picture);

}  // namespace glint
