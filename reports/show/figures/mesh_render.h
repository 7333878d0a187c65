// SPDX-License-Identifier: MIT
// What a camera sees of a mesh, and how far that is from the true surface.
#pragma once

#include "glint/core/triangle_mesh.h"
#include "glint/scene/camera.h"

namespace glint {

// Of the first face on the ray through each pixel's centre (Embree).
struct MeshRender {
  Image depth;   // [H][W][1] planar z, metres; 0: no face
  Image cosine;  // [H][W][1] |cos| of the angle between the ray and the face's normal; 0: no face
};

// The faces of the mesh have an area (clean_mesh); there may be none.
MeshRender render_mesh(const TriangleMesh& mesh, const Camera& camera);

// Lambert's law for a light at the camera, either side alike, over some light from everywhere;
// grey where there is no face. [H][W][3].
Image shaded_picture(const MeshRender& render);

inline constexpr float kNotScored = -1;

// Metres from each visible place of `whole` to `truth`, [H][W][1]; kNotScored where `scored`, the
// part of the same mesh that the protocol keeps, is not met at the same place; NaN: no face.
// `truth` has faces.
Image distance_map(
    const MeshRender& whole,
    const MeshRender& scored,
    const TriangleMesh& truth,
    const Camera& camera
);

// The limit of the colours, in metres: the largest distance at which F1 is reported.
float mesh_error_high();

// LegendBar::kError over [0, mesh_error_high()], stripes where nothing was scored. [H][W][3].
Image distance_picture(const Image& distances);

}  // namespace glint
