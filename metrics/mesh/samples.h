// SPDX-License-Identifier: MIT
// Points that stand for a surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "glint/core/triangle_mesh.h"

namespace glint {

struct SurfacePoints {
  std::vector<Vec3f> positions;  // metres
  std::vector<Vec3f> normals;    // unit, or empty: unknown
};

// What is compared: a mesh, or a point cloud that is its own samples.
using Surface = std::variant<TriangleMesh, SurfacePoints>;

double surface_area(const TriangleMesh& mesh);  // square metres
std::vector<Vec3f> face_normals(const TriangleMesh& mesh);

// `count` points with normals, uniform by area and stratified: the faces' areas are laid end to
// end, sample i falls on a uniform place of the i-th of `count` equal parts, and is uniform on the
// face it meets [Osada et al. 2002, Eq. 1]. In the order of the faces. Our own sampler and not
// CGAL's, which draws one point after the other and so cannot be split over threads.
// The mesh has faces, all with an area (clean_mesh). Same points for any number of threads.
SurfacePoints sample_surface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed);

// The points themselves, or a uniform subset of `count` in their order when there are more.
SurfacePoints sample_surface(const SurfacePoints& points, std::size_t count, std::uint64_t seed);

}  // namespace glint
