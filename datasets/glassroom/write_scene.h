// SPDX-License-Identifier: MIT
// The files of a GlassRoom scene, in the layout of GLINT's official release plus gt/:
//   images/<view>/000000.png                     sRGB-encoded, 8 bit
//   intri.yml extri.yml                          OpenCV FileStorage, world to camera, OpenCV axes
//   sparse/0/points3D.ply                        simulated SfM points
//   diffrens/<prior>/<view>/000000.png           simulated priors (glint/scene/maps.h)
//   gt/<truth>/<view>.exr                        (masks: .png), and gt/rgb/<view>.exr
//   gt/mesh.ply gt/mesh_behind.ply
// Radiance maps are linear and multiplied by the exposure: an image is their sRGB encoding,
// clamped.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "datasets/glassroom/path_tracer.h"
#include "glint/core/config.h"
#include "glint/core/files.h"
#include "glint/scene/ply.h"
#include "glint/scene/scene.h"

namespace glint {

std::string view_name(int view);  // "0007"

// clamp(srgb_encode(radiance * exposure)) in [0, 1].
Image display_image(ImageView radiance, float exposure);

void write_cameras(const fs::path& folder, const std::vector<Camera>& cameras);
void write_view(
    const fs::path& folder,
    int view,
    const PathTracerOutput& truth,
    const MapSet& priors,
    float exposure
);

// What a ray meets first, panes included, or first behind glass: everything but the panes.
enum class TruthLayer { kFirst, kBehind };
// All meshes of the layer as one, with edges of at most `max_edge` metres so that a face is
// either seen or not; colours are sRGB-encoded albedo.
TriangleMesh truth_mesh(const TraceScene& scene, TruthLayer layer, float max_edge = 0.1f);

// Relative path -> FNV-1a hash of the bytes, sixteen hexadecimal digits, for every file in
// `folder`.
Json file_hashes(const fs::path& folder);
// Names of the regular files below, with '/' between folders.
std::set<std::string> files_below(const fs::path& folder);

}  // namespace glint
