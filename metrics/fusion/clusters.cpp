// SPDX-License-Identifier: MIT
// Connected pieces of a mesh, by CGAL. Alone in its file: these headers compile for long.
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>

#include "metrics/fusion/tsdf.h"
#include "metrics/mesh/clean.h"

namespace glint {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Point = CGAL::Simple_cartesian<double>::Point_3;
using HalfEdges = CGAL::Surface_mesh<Point>;

// The piece of each face. Faces are turned alike and non-manifold edges cut open in a copy, as half
// edges need it; the order of the faces stays.
std::vector<std::size_t> pieces(const TriangleMesh& mesh, std::size_t& num_pieces) {
  std::vector<Point> points;
  for (const Vec3f& v : mesh.vertices)
    points.emplace_back(
        static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)
    );
  std::vector<std::array<std::size_t, 3>> faces;
  for (const auto& [a, b, c] : mesh.faces)
    faces.push_back(
        {static_cast<std::size_t>(a), static_cast<std::size_t>(b), static_cast<std::size_t>(c)}
    );
  pmp::orient_polygon_soup(points, faces);
  HalfEdges edges;
  pmp::polygon_soup_to_polygon_mesh(points, faces, edges);
  const auto piece = edges.add_property_map<HalfEdges::Face_index, std::size_t>("f:piece", 0).first;
  num_pieces = pmp::connected_components(edges, piece);
  std::vector<std::size_t> result;
  for (const auto face : edges.faces()) result.push_back(piece[face]);
  return result;
}

}  // namespace

TriangleMesh keep_large_clusters(const TriangleMesh& mesh, int min_triangles, ClusterCount* count) {
  const TriangleMesh clean = clean_mesh(mesh).mesh;
  std::size_t num_pieces = 0;
  const std::vector<std::size_t> piece = pieces(clean, num_pieces);
  std::vector<int> size(num_pieces, 0);
  for (const std::size_t p : piece) ++size[p];
  std::vector<std::uint8_t> keep;
  for (const std::size_t p : piece) keep.push_back(size[p] >= min_triangles);
  if (count != nullptr) {
    const auto dropped = [&](int s) { return s < min_triangles; };
    count->found = num_pieces;
    count->dropped = static_cast<std::size_t>(std::count_if(size.begin(), size.end(), dropped));
  }
  return select_faces(clean, keep);
}

}  // namespace glint
