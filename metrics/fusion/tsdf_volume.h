// SPDX-License-Identifier: MIT
// The part of fusion that needs Open3D. It lies in a module of its own (lib/libglint_tsdf.so) that
// is loaded when the first mesh is made: Open3D brings a hundred shared libraries, which other
// commands neither wait for nor count as their memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "glint/core/image.h"
#include "glint/core/triangle_mesh.h"
#include "glint/scene/camera.h"

namespace glint {

struct TsdfVolumeOptions {
  double voxel = 0, truncation = 0;  // metres
  int block = 16;                    // edge of what is allocated at once, in voxels
};

// Mind the module's boundary: only what is defined in headers crosses it.
class TsdfVolume {
 public:
  virtual ~TsdfVolume() = default;
  // depth: [H][W][1] planar z in metres, 0: none. rgb: [H][W][3] in [0, 1], empty: grey. Every
  // `depth_stride` pixels open blocks.
  virtual void integrate(
      ImageView depth, ImageView rgb, const Camera& camera, int depth_stride
  ) = 0;
  virtual TriangleMesh extract() const = 0;
  virtual std::size_t bytes_per_voxel() const = 0;
};

// Errors (kEnvironment): the module is not there, since Open3D was missing when this was built.
std::unique_ptr<TsdfVolume> make_tsdf_volume(const TsdfVolumeOptions& options);
// Whether make_tsdf_volume() can succeed.
bool has_tsdf_volume();

}  // namespace glint
