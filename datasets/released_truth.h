// SPDX-License-Identifier: MIT
// True geometry of 3D-FRONT-T as the evaluation of GLINT's release expects it, apart from the
// scenes:
//   geometry_gt/<scene>/depths_gt/val_depthZ_<n>.npy      planar depth, metres
//   geometry_gt/<scene>/normals_gt/val_normalCam_<n>.npy  unit, camera space, OpenCV axes
//   geometry_gt/<scene>/gt_mesh.ply
// n is the number in the camera's name, four digits; only views that are scored have files. Maps
// are as large as the stored pictures. geometry_gt/ lies beside the scenes' folders or in a
// scene's.
#pragma once

#include <string>

#include "datasets/scene_index.h"

namespace glint {

// Of the scene in that folder; empty: there is none.
fs::path released_truth(const fs::path& scene);

// Adds the files of the view that are there, of kinds that it has no file of.
void add_released_maps(const fs::path& truth, const std::string& view, MapFiles& files);

// The scene's true mesh: kTrueMesh, else the released one; kTrueMesh where neither is there. Of
// another surface, `mesh` of its folder.
inline constexpr const char* kTrueMesh = "gt/mesh.ply";
fs::path true_mesh(const fs::path& scene, const std::string& mesh = kTrueMesh);

}  // namespace glint
