// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/raster_saved.h"
#include "glint/render/tile_kernel.h"

namespace glint {

namespace {

// ---- forward -----------------------------------------------------------------------------------

template <class T, int kChannels>
struct ForwardVisitor {
  const TileContext& tile;
  const DistortionRange range;
  RasterSaved& saved;
  const int channels;
  PixelSums<T, kChannels> sums[kGroupsPerTile<T>];
  T visibility;
  unsigned blocks;
  const float* feature;
  const Splat* splat;

  ForwardVisitor(const TileContext& tile, const RasterSettings& settings, RasterSaved& saved)
      : tile(tile), range(distortion_range(settings)), saved(saved), channels(tile.input.channels) {
    for (auto& group : sums) group.clear();
  }

  std::uint64_t groups(TileEntry entry) const {
    return groups_of_blocks<T>(blocks_of(tile, tile.lists.boxes[entry.surfel]));
  }
  void begin(TileEntry entry) {
    visibility = T(0);
    blocks = 0;
    feature = &tile.input.features[static_cast<std::size_t>(entry.surfel) * channels];
    splat = &tile.lists.splats[entry.surfel];
  }
  void hit(int g, const SplatHit<T>& hit) {
    visibility += hit.weight;
    const bool counts = any(hit.transmittance_behind < hit.transmittance);  // or stops a pixel
    blocks |= static_cast<unsigned>(counts) << (g / kGroupsPerBlock<T>);
    sums[g].add(hit, feature, channels, splat->normal, range);
  }
  void end(TileEntry entry) {
    saved.pair_visibility[entry.pair] = lane_sum(visibility);
    saved.pair_blocks[entry.pair] = static_cast<std::uint8_t>(blocks);
  }
  void skip(TileEntry entry) {
    saved.pair_visibility[entry.pair] = 0;
    saved.pair_blocks[entry.pair] = 0;
  }

  void store(const TilePixels<T>& pixels, RasterOutput& out) const {
    for (int g = 0; g < kGroupsPerTile<T>; ++g) {
      const PixelSums<T, kChannels>& s = sums[g];
      const T alpha = T(1) - pixels.final_transmittance(g);
      for (int c = 0; c < channels; ++c) store_pixels(tile, out.features, g, c, s.features[c]);
      for (int c = 0; c < 3; ++c) store_pixels(tile, out.normal, g, c, s.normal[c]);
      store_pixels(tile, out.alpha, g, 0, alpha);
      store_pixels(tile, out.depth_sum, g, 0, s.depth);
      store_pixels(tile, out.depth_median, g, 0, s.median);
      store_pixels(tile, saved.final_transmittance, g, 0, pixels.final_transmittance(g));
      if (!range.on) continue;
      store_pixels(tile, saved.first_depth, g, 0, s.first_depth);
      store_pixels(tile, saved.moment1, g, 0, s.moment1);
      store_pixels(tile, saved.moment2, g, 0, s.moment2);
      store_pixels(tile, out.distortion, g, 0, distortion(alpha, s.moment1, s.moment2));
    }
  }
};

template <class T, int kChannels>
void forward_tile(
    const TileContext& tile, const RasterSettings& settings, RasterSaved& saved, RasterOutput& out
) {
  TilePixels<T> pixels(tile);
  ForwardVisitor<T, kChannels> visitor(tile, settings, saved);
  for_each_hit(tile, pixels, visitor);
  visitor.store(pixels, out);
}

// ---- backward ----------------------------------------------------------------------------------

constexpr int kMaxSums = splat_sums(kMaxChannels);

template <class T, int kChannels>
struct BackwardVisitor {
  static constexpr int kSums = splat_sums(kChannels > 0 ? kChannels : kMaxChannels);
  const TileContext& tile;
  const DistortionRange range;
  RasterSaved& saved;
  const int channels;
  PixelGradient<T, kChannels> pixels[kGroupsPerTile<T>];
  // Of the current surfel.
  T sums[kSums];
  const float* feature;
  const Splat* splat;

  BackwardVisitor(
      const TileContext& tile,
      const RasterSettings& settings,
      RasterSaved& saved,
      const RasterOutput& out,
      const RasterOutputGradient& g
  )
      : tile(tile), range(distortion_range(settings)), saved(saved), channels(tile.input.channels) {
    for (int i = 0; i < kGroupsPerTile<T>; ++i) load_group(i, out, g);
  }

  T load(const Image& image, int group, int channel) const {
    return image.empty() ? T(0) : load_pixels<T>(tile, image, group, channel, 0.0f);
  }
  void load_group(int i, const RasterOutput& out, const RasterOutputGradient& g) {
    PixelGradient<T, kChannels>& p = pixels[i];
    PixelSums<T, kChannels> s;
    s.depth = load(out.depth_sum, i, 0);
    p.total_alpha = load(out.alpha, i, 0);
    p.alpha = load(g.alpha, i, 0);
    p.depth = load(g.depth_sum, i, 0);
    p.median = load(g.depth_median, i, 0);
    for (int c = 0; c < channels; ++c) {
      p.features[c] = load(g.features, i, c);
      s.features[c] = load(out.features, i, c);
    }
    for (int c = 0; c < 3; ++c) {
      p.normal[c] = load(g.normal, i, c);
      s.normal[c] = load(out.normal, i, c);
    }
    if (range.on) {
      p.distortion = load(g.distortion, i, 0);
      p.first_depth = load_pixels<T>(tile, saved.first_depth, i, 0, 1.0f);
      p.moment1 = load(saved.moment1, i, 0);
      p.moment2 = load(saved.moment2, i, 0);
    }
    p.start(s, load(saved.final_transmittance, i, 0), channels, range.on);
  }

  std::uint64_t groups(TileEntry entry) const {
    return groups_of_blocks<T>(saved.pair_blocks[entry.pair]);
  }
  void begin(TileEntry entry) {
    std::fill_n(sums, splat_sums(channels), T(0));
    feature = &tile.input.features[static_cast<std::size_t>(entry.surfel) * channels];
    splat = &tile.lists.splats[entry.surfel];
  }
  void hit(int g, const SplatHit<T>& hit) {
    pixels[g].hit(hit, *splat, feature, channels, range, sums);
  }
  float* slot_of(TileEntry entry) const {
    return &saved.pair_gradients[entry.pair * static_cast<std::size_t>(splat_sums(channels))];
  }
  void skip(TileEntry) {}  // sum_pairs() leaves out pairs without blocks
  void end(TileEntry entry) {
    const int width = splat_sums(channels);
    float* slot = slot_of(entry);
    if constexpr (kLanesOf<T> == 8)
      for (int i = 0; i < width; i += 8) lane_sums(&sums[i]).store(slot + i);
    else
      for (int i = 0; i < width; ++i) slot[i] = sums[i];
  }
};

template <class T, int kChannels>
void backward_tile(
    const TileContext& tile,
    const RasterSettings& settings,
    RasterSaved& saved,
    const RasterOutput& out,
    const RasterOutputGradient& g
) {
  TilePixels<T> pixels(tile);
  BackwardVisitor<T, kChannels> visitor(tile, settings, saved, out, g);
  for_each_hit(tile, pixels, visitor);
}

// Calls body<T, kChannels> for the lane type and channel count of this call.
template <class F>
void dispatch(bool scalar, int channels, F&& body) {
  const auto with_channels = [&](auto lanes) {
    using T = decltype(lanes);
    if (channels == 3) return body.template operator()<T, 3>();
    if (channels == 5) return body.template operator()<T, 5>();
    return body.template operator()<T, 0>();
  };
  scalar ? with_channels(0.0f) : with_channels(Float8(0.0f));
}

template <class F>
void for_each_tile(
    const RasterInput& input, const TileLists& lists, ImageSize size, float near_plane, F&& body
) {
  parallel_for(lists.num_tiles(), 2, [&](std::size_t i) {
    const int tile = static_cast<int>(i);
    body(TileContext{input, lists, size, near_plane, tile % lists.tiles_x, tile / lists.tiles_x});
  });
}

// ---- sums over a surfel's tiles ----------------------------------------------------------------

void sum_pairs(const RasterSaved& saved, std::size_t surfel, int width, float* sums) {
  const std::vector<std::uint32_t>& pair_begin = saved.lists.pair_begin;
  std::fill_n(sums, width, 0.0f);
  for (std::uint32_t pair = pair_begin[surfel]; pair < pair_begin[surfel + 1]; ++pair) {
    if (saved.pair_blocks[pair] == 0) continue;
    const float* slot = &saved.pair_gradients[static_cast<std::size_t>(pair) * width];
    for (int i = 0; i < width; i += 8)
      (Float8::load(sums + i) + Float8::load(slot + i)).store(sums + i);
  }
}

template <class T>
ProjectedSurfel<T> projected_gradient(const float* sums, int width) {
  const auto at = [&](int i) { return load_strided<T>(sums + i, width); };
  const auto at3 = [&](int i) { return Vec3<T>{at(i), at(i + 1), at(i + 2)}; };
  ProjectedSurfel<T> g{};
  g.map = {at3(kSumGx), at3(kSumGy), at3(kSumG0), at(kSumDet)};
  g.center_x = at(kSumCenterX);
  g.center_y = at(kSumCenterY);
  g.z_center = at(kSumZCenter);
  g.normal = at3(kSumNormal);
  return g;
}

// Surfels without pairs get exact zeros, whatever their parameters (they may not be finite).
template <class T>
void zero_unseen(Mask<T> seen, SurfelGeometry<T>& g, Vec3<T>& dL_dm) {
  const T zero(0);
  const Vec3<T> zero3{zero, zero, zero};
  g.mean = select<T>(seen, g.mean, zero3);
  dL_dm = select<T>(seen, dL_dm, zero3);
  for (T* value :
       {&g.scale.x, &g.scale.y, &g.rotation.w, &g.rotation.x, &g.rotation.y, &g.rotation.z})
    *value = select(seen, *value, zero);
}

template <class T>
void store3(FloatArray& array, std::size_t i, Vec3<T> v) {
  for (int k = 0; k < 3; ++k) store_strided(&array[3 * i + k], 3, v[k]);
}

template <class T>
void surfel_vjp_lanes(
    const RasterInput& input,
    const CameraOf<float>& camera,
    const RasterSaved& saved,
    std::size_t first,
    RasterGradient& out
) {
  const int width = splat_sums(input.channels);
  alignas(32) float sums[8 * kMaxSums];
  float z[8], num_pairs[8];
  for (int i = 0; i < kLanesOf<T>; ++i) {
    sum_pairs(saved, first + i, width, sums + i * width);
    std::copy_n(
        sums + i * width + kSumFeatures, input.channels, &out.features[(first + i) * input.channels]
    );
    out.opacities[first + i] = sums[i * width + kSumOpacity];
    num_pairs[i] = static_cast<float>(saved.lists.boxes[first + i].num_tiles());
    z[i] = num_pairs[i] > 0 ? saved.lists.splats[first + i].z_center : 1.0f;
  }
  const CameraOf<T> c = broadcast_camera<T>(camera);
  const SurfelGeometry<T> surfel = load_geometry<T>(input, first);
  SurfelGeometry<T> g{};
  Vec3<T> dL_dm;
  project_surfel_vjp(surfel, c, projected_gradient<T>(sums, width), g, dL_dm);
  zero_unseen<T>(load_lanes<T>(num_pairs) > T(0), g, dL_dm);
  store3(out.means, first, g.mean);
  store_strided(&out.scales[2 * first], 2, g.scale.x);
  store_strided(&out.scales[2 * first + 1], 2, g.scale.y);
  const T rotation[4] = {g.rotation.w, g.rotation.x, g.rotation.y, g.rotation.z};
  for (int k = 0; k < 4; ++k) store_strided(&out.rotations[4 * first + k], 4, rotation[k]);
  const Vec2<T> screen = screen_gradient(dL_dm, load_lanes<T>(z), c);
  store_strided(&out.screen[2 * first], 2, screen.x);
  store_strided(&out.screen[2 * first + 1], 2, screen.y);
}

void surfel_vjp(
    const RasterInput& input,
    const Camera& camera,
    float near_plane,
    const RasterSaved& saved,
    bool scalar,
    RasterGradient& out
) {
  const CameraOf<float> c = camera_of(camera, near_plane);
  parallel_for_blocks(input.count, 512, [&](std::size_t begin, std::size_t end) {
    std::size_t i = begin;
    if (!scalar)
      for (; i + 8 <= end; i += 8) surfel_vjp_lanes<Float8>(input, c, saved, i, out);
    for (; i < end; ++i) surfel_vjp_lanes<float>(input, c, saved, i, out);
  });
}

void fit_saved(const RasterSettings& settings, ImageSize size, RasterSaved& saved) {
  fit(saved.final_transmittance, size, 1);
  if (!settings.with_distortion) return;
  for (Image* image : {&saved.first_depth, &saved.moment1, &saved.moment2}) fit(*image, size, 1);
}

}  // namespace

void rasterize_forward_cpu(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings,
    RasterOutput& output,
    bool scalar,
    RasterSaved& saved
) {
  TileLists& lists = saved.lists;
  build_tile_lists(input, camera, settings.near_plane, scalar, lists);
  fit_saved(settings, camera.size(), saved);
  saved.pair_visibility.resize(lists.num_pairs());
  saved.pair_blocks.resize(lists.num_pairs());
  dispatch(scalar, input.channels, [&]<class T, int kChannels>() {
    for_each_tile(input, lists, camera.size(), settings.near_plane, [&](const TileContext& tile) {
      forward_tile<T, kChannels>(tile, settings, saved, output);
    });
  });
  parallel_for(input.count, 2048, [&](std::size_t i) {
    float sum = 0;
    for (std::uint32_t pair = lists.pair_begin[i]; pair < lists.pair_begin[i + 1]; ++pair)
      sum += saved.pair_visibility[pair];
    output.visibility[i] = sum;
    output.in_view[i] = lists.boxes[i].empty() ? 0 : 1;
  });
}

void rasterize_backward_cpu(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings,
    const RasterOutput& output,
    const RasterOutputGradient& dL_doutput,
    RasterGradient& gradient,
    bool scalar,
    RasterSaved& saved
) {
  const TileLists& lists = saved.lists;
  saved.pair_gradients.resize(lists.num_pairs() * splat_sums(input.channels));
  dispatch(scalar, input.channels, [&]<class T, int kChannels>() {
    for_each_tile(input, lists, camera.size(), settings.near_plane, [&](const TileContext& tile) {
      backward_tile<T, kChannels>(tile, settings, saved, output, dL_doutput);
    });
  });
  surfel_vjp(input, camera, settings.near_plane, saved, scalar, gradient);
}

std::size_t raster_pixel_pairs(const RasterSaved& saved) {
  std::size_t sum = 0;
  for (const PixelBox& box : saved.lists.boxes) sum += box.num_pixels();
  return sum;
}

}  // namespace glint
