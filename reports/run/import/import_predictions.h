// SPDX-License-Identifier: MIT
// Renders of another program become a run folder like our own, so that scoring, records, tables,
// strips and the report treat them alike.
#pragma once

#include "reports/run/import/prediction_files.h"
#include "reports/run/records/run_folder.h"

namespace glint {

enum class DepthConvention { kPlanar, kRay };
NLOHMANN_JSON_SERIALIZE_ENUM(
    DepthConvention, {{DepthConvention::kPlanar, "planar"}, {DepthConvention::kRay, "ray"}}
)

// Camera space with OpenCV's axes (x right, y down, z forward), with OpenGL's (y up, z backward),
// or the world's axes.
enum class NormalAxes { kOpencv, kOpengl, kWorld };
NLOHMANN_JSON_SERIALIZE_ENUM(
    NormalAxes,
    {{NormalAxes::kOpencv, "opencv"},
     {NormalAxes::kOpengl, "opengl"},
     {NormalAxes::kWorld, "world"}}
)

struct ImportOptions {
  DepthConvention depth = DepthConvention::kPlanar;
  NormalAxes normals = NormalAxes::kOpencv;
  std::string mesh;  // file; empty: the one that find_predictions() finds
  std::string gltf_up = "y";
  double depth_scale = 0;  // metres of a step of integers; 0: found, or an error

  template <class V>
  void visit(V&& v) {
    v("depth", depth, "planar: z in metres; ray: distance along the ray");
    v("normals", normals, "opencv, opengl or world");
    v("mesh", mesh, "mesh to score; empty: found in the folder");
    v("gltf_up", gltf_up, "of a mesh as glTF: the axis that was up before, y or z");
    v("depth_scale", depth_scale, "metres of a step of depth as integers; 0: found, or none");
  }
};

// In our conventions: depth planar, normals in camera space with OpenCV's axes.
void to_our_depth(Image& depth, const Camera& camera, DepthConvention kind);
void to_our_normals(Image& normals, const Camera& camera, NormalAxes axes);

// Fills spec.folder (config.json, renders/, strip.png, mesh.ply) from the predictions in `folder`.
// Returns notes for the record: how files were matched, maps that look like another convention than
// stated. Errors (kBadPrediction): find_predictions()'s; unreadable files; another size than the
// view's.
std::vector<std::string> import_predictions(
    const fs::path& folder, const Scene& scene, const RunSpec& spec, const ImportOptions& options
);

}  // namespace glint
