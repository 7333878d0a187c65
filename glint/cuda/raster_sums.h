// SPDX-License-Identifier: MIT
// What rasterisation sums over a surfel's pixels, from what warps left of them (raster_bodies.h),
// and from there back to the surfel's parameters. One warp a surfel, always in the same order.
#pragma once

#include "glint/cuda/raster_bodies.h"

namespace glint::gpu {

// Per surfel, shapes of RasterOutput; null where a call has them not.
struct DeviceSeen {
  float* visibility;
  std::uint8_t* in_view;  // 1: reached at least one tile
  float *owned_pixels, *radii;
};

inline constexpr int kSumThreads = 256;
inline constexpr std::size_t kSumSurfels = kSumThreads / kWarp;  // of a block
struct NothingShared {};

// Sums over a surfel's slots, and the ranks of those that were seen.
struct SumSlots {
  static constexpr int kThreads = kSumThreads;
  using Shared = NothingShared;
  DeviceLists lists;
  DeviceSlots slots;
  DeviceSeen out;
  PairCounts* num_rows;  // [N] slots that were seen

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared&) const {
    block.each_warp([&](auto& warp) {
      const std::size_t i = static_cast<std::size_t>(block.index) * kSumSurfels +
                            static_cast<std::size_t>(warp.index);
      if (i < lists.count) sum_surfel(warp, i);
    });
  }

 private:
  template <class Warp>
  GLINT_HD void sum_surfel(Warp& warp, std::size_t i) const {
    const std::uint32_t begin = lists.first_slot(i), end = lists.first_slot(i + 1);
    PerLane<Warp, float> visibility, owned;
    warp.each([&](int lane) { visibility[lane] = owned[lane] = 0; });
    std::uint32_t num_seen = 0;
    for (std::uint32_t first = begin; first < end; first += kWarp) {
      const std::uint32_t seen = warp.ballot([&](int lane) {
        const std::uint32_t slot = first + static_cast<std::uint32_t>(lane);
        return slot < end && add(slot, visibility[lane], owned[lane]);
      });
      warp.each([&](int lane) {
        const std::uint32_t slot = first + static_cast<std::uint32_t>(lane);
        if (slot < end) slots.ranks[slot] = rank_of(seen, lane, num_seen);
      });
      num_seen += static_cast<std::uint32_t>(count_bits(seen));
    }
    const float of_visibility = warp.sum(visibility), of_owned = warp.sum(owned);
    warp.each([&](int lane) {
      if (lane == 0) store(i, of_visibility, of_owned, num_seen);
    });
  }
  // Whether the slot was seen.
  GLINT_HD bool add(std::uint32_t slot, float& visibility, float& owned) const {
    const float value = slots.visibility[slot];
    if (value == 0) return false;
    if (value > 0) visibility += value;
    if (slots.owned != nullptr) owned += static_cast<float>(slots.owned[slot]);
    return true;
  }
  GLINT_HD static std::uint32_t rank_of(std::uint32_t seen, int lane, std::uint32_t before) {
    if ((seen >> lane & 1) == 0) return kUnseen;
    const std::uint32_t in_front = seen & ((1u << lane) - 1);
    return before + static_cast<std::uint32_t>(count_bits(in_front));
  }
  GLINT_HD void store(std::size_t i, float visibility, float owned, std::uint32_t num_seen) const {
    out.visibility[i] = visibility;
    out.in_view[i] = lists.in_view(i) ? 1 : 0;
    if (out.owned_pixels != nullptr) out.owned_pixels[i] = owned;
    num_rows[i] = pair_counts(num_seen, 0);
  }
};

struct ScreenRadii {
  DeviceSurfels surfels;
  CameraOf<float> camera;
  DeviceLists lists;
  float* radii;

  GLINT_HD void operator()(std::size_t i) const {
    const float max_rho = max_rho_of(surfels.opacities[i]);
    radii[i] = lists.in_view(i) ? screen_radius(geometry_at(surfels, i), camera, max_rho) : 0.0f;
  }
};

// Gradients of a surfel, from the rows of its slots.
template <int kSums>
struct SumRows {
  static constexpr int kThreads = kSumThreads;
  using Shared = NothingShared;
  static constexpr int kWide = (kSums + kWarp - 1) / kWarp;
  static constexpr int kAtOnce = 4;  // rows whose loads are under way together
  std::size_t count;
  const PairCounts* first_row;  // [count + 1]
  const PairTotals* totals;
  const float* rows;  // [rows][kSums]
  float* sums;        // [count][kSums]

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared&) const {
    block.each_warp([&](auto& warp) {
      const std::size_t i = static_cast<std::size_t>(block.index) * kSumSurfels +
                            static_cast<std::size_t>(warp.index);
      if (i >= count) return;
      warp.each([&](int lane) {
        for (int c = lane; c < kSums; c += kWarp) sums[i * kSums + c] = sum(i, c);
      });
    });
  }

 private:
  GLINT_HD float sum(std::size_t surfel, int c) const {
    if (totals->fit == 0) return 0;
    const std::uint32_t end = pairs_of(first_row[surfel + 1]);
    float result = 0;
    for (std::uint32_t row = pairs_of(first_row[surfel]); row < end; row += kAtOnce) {
      float values[kAtOnce];
      for (int k = 0; k < kAtOnce; ++k) values[k] = row + k < end ? at(row + k, c) : 0.0f;
      for (int k = 0; k < kAtOnce; ++k) result += values[k];
    }
    return result;
  }
  GLINT_HD float at(std::uint32_t row, int c) const {
    return rows[static_cast<std::size_t>(row) * kSums + static_cast<std::size_t>(c)];
  }
};

// dL/d(parameters), shapes of RasterGradient.
struct DeviceGradients {
  float *means, *scales, *rotations, *opacities, *features, *screen;
  float* screen_abs;  // null: not asked for
};

// From the sums over a surfel's pixels back to its parameters.
struct SurfelVjp {
  DeviceSurfels surfels;
  CameraOf<float> camera;
  DeviceLists lists;
  const float* sums;  // [N][stride]
  int stride;
  MapChannels has;
  bool screen_with_low_pass;
  DeviceGradients out;

  GLINT_HD void operator()(std::size_t i) const {
    const float* s = sums + i * static_cast<std::size_t>(stride);
    const bool seen = lists.in_view(i);
    const ProjectedSurfel<float> g =
        projected_gradient<float>(has, [s](int slot) { return s[slot]; });
    SurfelGeometry<float> dL_dsurfel{};
    Vec3f dL_dm{};
    // Surfels without pairs get exact zeros, whatever their parameters (they may not be finite).
    if (seen)
      project_surfel_vjp(
          geometry_at(surfels, i), camera, g, screen_with_low_pass, dL_dsurfel, dL_dm
      );
    const float z = seen ? lists.splats[i].z_center : 1.0f;
    store(i, s, dL_dsurfel, screen_gradient(dL_dm, z, camera));
  }

 private:
  GLINT_HD void store(std::size_t i, const float* s, const SurfelGeometry<float>& g, Vec2f screen)
      const {
    for (int k = 0; k < 3; ++k) out.means[3 * i + static_cast<std::size_t>(k)] = g.mean[k];
    out.scales[2 * i] = g.scale.x;
    out.scales[2 * i + 1] = g.scale.y;
    const float rotation[4] = {g.rotation.w, g.rotation.x, g.rotation.y, g.rotation.z};
    for (std::size_t k = 0; k < 4; ++k) out.rotations[4 * i + k] = rotation[k];
    out.opacities[i] = s[kSumOpacity];
    const auto channels = static_cast<std::size_t>(surfels.channels);
    const float* of_features = s + feature_slot(has);
    for (std::size_t c = 0; c < channels; ++c) out.features[channels * i + c] = of_features[c];
    out.screen[2 * i] = screen.x;
    out.screen[2 * i + 1] = screen.y;
    if (out.screen_abs == nullptr) return;
    out.screen_abs[2 * i] = 0.5f * camera.width * s[kSumScreenAbsX];
    out.screen_abs[2 * i + 1] = 0.5f * camera.height * s[kSumScreenAbsY];
  }
};

}  // namespace glint::gpu
