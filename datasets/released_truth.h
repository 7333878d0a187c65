// SPDX-License-Identifier: MIT
// True geometry of 3D-FRONT-T as the evaluation of GLINT's release expects it, beside the scenes'
// folders, of whatever format these are:
//   geometry_gt/<scene>/depths_gt/val_depthZ_<n>.npy      planar depth, metres
//   geometry_gt/<scene>/normals_gt/val_normalCam_<n>.npy  unit, camera space, OpenCV axes
//   geometry_gt/<scene>/gt_mesh.ply
// n is the number that the view's name ends in, four digits; only views that are scored have files.
// Maps are as large as the stored pictures.
#pragma once

#include <string>

#include "datasets/scene_index.h"

namespace glint {

// Of the scene in that folder, or in that which a link leads to; empty: there is none.
fs::path released_truth(const fs::path& scene);

// Adds the files that are there to views without a file of the kind. Where several views have one
// number, none of them gets any, and a remark says so.
void add_released_truth(const fs::path& scene, SceneIndex& index);

// The view's true depth in `truth`, a released_truth(); empty: there is none.
fs::path released_depth(const fs::path& truth, const std::string& view);

// The scene's true mesh: kTrueMesh, else a model of its name (mesh_files.h), else the released one;
// kTrueMesh where none is there. Of another surface, `mesh` of its folder.
inline constexpr const char* kTrueMesh = "gt/mesh.ply";
fs::path true_mesh(const fs::path& scene, const std::string& mesh = kTrueMesh);

}  // namespace glint
