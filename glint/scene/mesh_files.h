// SPDX-License-Identifier: MIT
// Triangle meshes in whatever format they come.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/gltf_axes.h"
#include "glint/core/service.h"
#include "glint/core/triangle_mesh.h"
#include "glint/scene/ply.h"

namespace glint {

// In lower case, best first. PLY may also hold points.
inline const std::vector<std::string> kMeshExtensions{".ply", ".glb", ".gltf", ".obj", ".stl"};

// Of the name, in lower case.
std::string mesh_extension(const fs::path& path);

// OBJ, glTF 2.0 and STL (assimp, library glint_models): axes and units as stored, of glTF that is y
// up, in metres; colours of vertices where all parts have them. Errors (kBadReference): as ply.h.
inline constinit Service<TriangleMesh(const fs::path&)> read_model{
    "reading OBJ, glTF and STL", "write the mesh as PLY"};

// By its extension. Errors (kBadReference): read_mesh_ply()'s, read_model's, another extension.
TriangleMesh read_mesh(const fs::path& path, NonFinite vertices = NonFinite::kReject);

void turn_back(TriangleMesh& mesh);  // of a glTF, each corner by turned_back() (gltf_axes.h)

// `path`, or where nothing is there, a mesh of that name with another of kMeshExtensions; `path`
// where there is none either.
fs::path mesh_or_model(const fs::path& path);

}  // namespace glint
