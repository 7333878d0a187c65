// SPDX-License-Identifier: MIT
// In place of clusters.cpp, which needs CGAL. Never called: a lean build has no module that fuses.
#include "glint/core/error.h"
#include "metrics/fusion/tsdf.h"

namespace glint {

TriangleMesh keep_large_clusters(const TriangleMesh&, int, ClusterCount*) {
  throw Error(ExitCode::kEnvironment, "meshes need the full build; this is a lean one");
}

}  // namespace glint
