// SPDX-License-Identifier: MIT
// Meshes of a house as the path tracer takes them.
#pragma once

#include "datasets/front3d/house.h"
#include "datasets/glassroom/shapes.h"

namespace glint {

// Flat triangles with texture coordinates in metres along the surface: the two axes of a floor, of
// a wall along it and downwards. Triangles without an area are left out. Moved by -origin.
TraceMesh surface_mesh(const HouseMesh& mesh, Vec3f origin);
// With the mesh's own texture coordinates, through its material's transform.
TraceMesh own_surface_mesh(const HouseMesh& mesh, const HouseMaterial& material, Vec3f origin);

double area_of(const TraceMesh& mesh);

// Height of the mesh's lowest point above (x, y) that is higher than `above`; none: infinity.
float lowest_above(const TraceMesh& mesh, Vec2f p, float above);

}  // namespace glint
