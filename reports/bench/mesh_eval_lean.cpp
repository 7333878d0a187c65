// SPDX-License-Identifier: MIT
// In place of mesh_eval.cpp, which needs Embree and CGAL: a lean build makes and scores no meshes.
#include "reports/bench/mesh_eval.h"

namespace glint {

std::map<std::string, double>
score_meshes(const RunSpec&, const Scene&, const MeshProtocol&, Json&) {
  return {};
}

}  // namespace glint
