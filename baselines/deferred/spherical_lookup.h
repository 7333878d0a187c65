// SPDX-License-Identifier: MIT
// A map over all directions (spherical_map.h) with its mip levels, looked up for the pixels of an
// image, and the way back to texels, directions and roughness.
#pragma once

#include <span>

#include "baselines/deferred/spherical_map_kernels.h"
#include "glint/core/image.h"

namespace glint {

class SphericalLookup {
 public:
  SphericalLookup() = default;
  // height rows, 2 height columns. Errors (kUsage): height < 2, channels < 1.
  SphericalLookup(int height, int channels);

  const MapShape& shape() const { return shape_; }
  std::size_t num_values() const;  // of level 0, [height][2 height][channels]

  // Makes the levels of these values of level 0; once after they have changed. Errors (kUsage):
  // not num_values().
  void set_texels(const FloatArray& level0);
  // directions: [H][W][3] unit, world; zero: the value is zero. roughness: [H][W][1]; below 0 and
  // above 1 as those. Both must stay as they are until look_up_vjp(). Returns [H][W][channels],
  // valid until the next call.
  const Image& look_up(const Image& directions, const Image& roughness);
  // Back through the last look_up(): fills dL_ddirections [H][W][3] and dL_droughness [H][W][1],
  // adds to dL_dlevel0. The same bytes for any number of threads, and every time on a GPU.
  void look_up_vjp(
      const Image& dL_dvalues, Image& dL_ddirections, Image& dL_droughness, FloatArray& dL_dlevel0
  );

 private:
  void sort_taps();
  void sort_taps_on_gpu();
  void texels_vjp(const Image& dL_dvalues, FloatArray& dL_dlevel0);
  void gather_texels(const Image& dL_dvalues);

  MapShape shape_;
  FloatArray texels_, dL_dtexels_;  // all levels
  const Image *directions_ = nullptr, *roughness_ = nullptr;
  Image values_;
  Array<std::uint32_t> keys_, begins_, taps_;  // taps by key (counting sort)
  Array<TexelWeights> weights_;
  FloatArray windows_;  // sums of taps that lie together, on a GPU
};

}  // namespace glint
