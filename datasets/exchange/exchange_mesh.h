// SPDX-License-Identifier: MIT
// Meshes of a scene as Wavefront OBJ.
#pragma once

#include <string>

#include "datasets/glassroom/trace_scene.h"

namespace glint {

std::string exchange_material_id(std::size_t material);  // "material_7": in OBJ and JSON

// An object `mesh_<i>` each, its name as a comment; every vertex with its own normal and texture
// coordinate, where the mesh has them. As OBJ has it, v = 0 is the lower edge of the picture.
std::string exchange_meshes(const TraceScene& scene);

}  // namespace glint
