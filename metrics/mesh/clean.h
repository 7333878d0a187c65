// SPDX-License-Identifier: MIT
// What a mesh must not bring into a comparison: faces without a place, without area, or twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "glint/core/triangle_mesh.h"

namespace glint {

// Faces dropped, each under the first reason that holds; config_to_json() prints it.
struct CleanReport {
  std::size_t faces_before = 0, not_finite = 0, zero_area = 0, duplicate = 0, faces_after = 0;
  std::size_t non_manifold_edges = 0;
  template <class V>
  void visit(V&& v) {
    v("faces_before", faces_before, "as read");
    v("not_finite", not_finite, "dropped: a corner is not finite");
    v("zero_area", zero_area, "dropped: the height is below 1e-7 of the longest edge");
    v("duplicate", duplicate, "dropped: an earlier face has the same three corners");
    v("faces_after", faces_after, "that count");
    v("non_manifold_edges", non_manifold_edges, "of more than two faces; kept");
  }
};

struct CleanMesh {
  TriangleMesh mesh;
  CleanReport report;
};

// Drops faces with a corner that is not finite, faces without area (their height is below what
// single precision resolves: no normal, and no sample falls on them), and repeated faces: same
// corner positions in any order or winding, so that a wall stored once for either side has its area
// once. Non-manifold edges harm no distance: counted, kept. Vertices without a face go.
CleanMesh clean_mesh(const TriangleMesh& mesh);

// The faces with a non-zero entry, in their order, and the vertices they use.
TriangleMesh select_faces(const TriangleMesh& mesh, std::span<const std::uint8_t> keep);

}  // namespace glint
