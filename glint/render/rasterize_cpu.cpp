// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/rasterize.h"
#include "glint/render/tile_kernel.h"

namespace glint {

struct RasterSaved {
  TileLists lists;
  Image final_transmittance;  // [H][W][1]
  // Of the distortion loss, [H][W][1]: depth of the first hit; sum w m, sum w m^2 relative to it.
  Image first_depth, moment1, moment2;
  std::vector<float> pair_visibility;  // [pairs]
  std::vector<float> pair_gradients;   // [pairs][slot_width]
};

namespace {

// ---- forward -----------------------------------------------------------------------------------

// kChannels > 0: known at compile time; 0: input.channels.
template <class T, int kChannels>
struct ForwardVisitor {
  const TileContext& tile;
  const RasterSettings& settings;
  float* pair_visibility;
  int channels;
  T features[kChannels > 0 ? kChannels : kMaxChannels][kGroupsPerTile<T>] = {};
  T depth[kGroupsPerTile<T>] = {}, normal[3][kGroupsPerTile<T>] = {};
  T median[kGroupsPerTile<T>] = {};
  T first_depth[kGroupsPerTile<T>];
  T moment1[kGroupsPerTile<T>] = {}, moment2[kGroupsPerTile<T>] = {};
  T visibility;
  const float* feature;
  const Splat* splat;

  ForwardVisitor(const TileContext& tile, const RasterSettings& settings, float* pair_visibility)
      : tile(tile),
        settings(settings),
        pair_visibility(pair_visibility),
        channels(tile.input.channels) {
    std::fill_n(first_depth, kGroupsPerTile<T>, T(1));
  }
  int num_channels() const { return kChannels > 0 ? kChannels : channels; }

  void begin(TileEntry entry) {
    visibility = T(0);
    feature = &tile.input.features[static_cast<std::size_t>(entry.surfel) * channels];
    splat = &tile.lists.splats[entry.surfel];
  }
  void hit(int g, const TileHit<T>& hit) {
    const T w = hit.weight;
    visibility += w;
    for (int c = 0; c < num_channels(); ++c)
      features[c][g] = fma_of(w, T(feature[c]), features[c][g]);
    depth[g] = fma_of(w, hit.depth, depth[g]);
    for (int c = 0; c < 3; ++c) normal[c][g] = fma_of(w, T(splat->normal[c]), normal[c][g]);
    const auto is_median = hit.valid & (hit.transmittance > T(0.5f));
    median[g] = select(is_median, hit.depth, median[g]);
    if (settings.with_distortion) add_moments(g, hit);
  }
  void add_moments(int g, const TileHit<T>& hit) {
    const T z = select(hit.valid, hit.depth, T(1));
    first_depth[g] = select(hit.valid & (hit.transmittance >= T(1)), z, first_depth[g]);
    const T near(settings.distortion_near), far(settings.distortion_far);
    const T m = distortion_depth(z, first_depth[g], near, far);
    moment1[g] = fma_of(hit.weight, m, moment1[g]);
    moment2[g] = fma_of(hit.weight, m * m, moment2[g]);
  }
  void end(TileEntry entry) { pair_visibility[entry.pair] = lane_sum(visibility); }
  void skip(TileEntry entry) { pair_visibility[entry.pair] = 0; }

  void store(const TilePixels<T>& pixels, RasterOutput& out, RasterSaved& saved) const {
    for (int g = 0; g < kGroupsPerTile<T>; ++g) {
      const T alpha = T(1) - pixels.final_transmittance(g);
      for (int c = 0; c < num_channels(); ++c)
        store_pixels(tile, out.features, g, c, features[c][g]);
      for (int c = 0; c < 3; ++c) store_pixels(tile, out.normal, g, c, normal[c][g]);
      store_pixels(tile, out.alpha, g, 0, alpha);
      store_pixels(tile, out.depth_sum, g, 0, depth[g]);
      store_pixels(tile, out.depth_median, g, 0, median[g]);
      store_pixels(tile, saved.final_transmittance, g, 0, pixels.final_transmittance(g));
      if (!settings.with_distortion) continue;
      store_pixels(tile, saved.first_depth, g, 0, first_depth[g]);
      store_pixels(tile, saved.moment1, g, 0, moment1[g]);
      store_pixels(tile, saved.moment2, g, 0, moment2[g]);
      store_pixels(tile, out.distortion, g, 0, distortion(alpha, moment1[g], moment2[g]));
    }
  }
};

template <class T, int kChannels>
void forward_tile(
    const TileContext& tile, const RasterSettings& settings, RasterSaved& saved, RasterOutput& out
) {
  TilePixels<T> pixels(tile);
  ForwardVisitor<T, kChannels> visitor(tile, settings, saved.pair_visibility.data());
  for_each_hit(tile, pixels, visitor);
  visitor.store(pixels, out, saved);
}

// ---- backward ----------------------------------------------------------------------------------

// Sums over a tile's pixels that one pair hands to its surfel.
enum PairSum {
  kSumGx = 0,  // 3: zeta's gradient times X
  kSumGy = 3,  // 3: times Y
  kSumG0 = 6,  // 3
  kSumDet = 9,
  kSumOpacity = 10,
  kSumCenterX = 11,
  kSumCenterY = 12,
  kSumZCenter = 13,
  kSumNormal = 14,   // 3
  kSumFeatures = 17  // channels
};
constexpr int kMaxSums = (kSumFeatures + kMaxChannels + 7) / 8 * 8;

int slot_width(int channels) { return (kSumFeatures + channels + 7) / 8 * 8; }

template <class T, int kChannels>
struct BackwardVisitor {
  static constexpr int kSums = kChannels > 0 ? (kSumFeatures + kChannels + 7) / 8 * 8 : kMaxSums;
  const TileContext& tile;
  const RasterSettings& settings;
  RasterSaved& saved;
  int channels;
  // Gradients and totals of the tile's pixels.
  T g_features[kChannels > 0 ? kChannels : kMaxChannels][kGroupsPerTile<T>];
  T g_alpha[kGroupsPerTile<T>], g_depth[kGroupsPerTile<T>], g_median[kGroupsPerTile<T>];
  T g_normal[3][kGroupsPerTile<T>], g_distortion[kGroupsPerTile<T>];
  T alpha[kGroupsPerTile<T>];
  T first_depth[kGroupsPerTile<T>], moment1[kGroupsPerTile<T>], moment2[kGroupsPerTile<T>];
  T median_behind[kGroupsPerTile<T>];  // the median hit is the first to leave this or less
  T remaining[kGroupsPerTile<T>];      // S minus the prefix so far, see blend_alpha_vjp
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
      : tile(tile), settings(settings), saved(saved), channels(tile.input.channels) {
    for (int i = 0; i < kGroupsPerTile<T>; ++i) load_group(i, out, g);
  }
  int num_channels() const { return kChannels > 0 ? kChannels : channels; }
  bool with_distortion() const { return settings.with_distortion; }

  T load(const Image& image, int group, int channel) const {
    return image.empty() ? T(0) : load_pixels<T>(tile, image, group, channel, 0.0f);
  }
  void load_group(int i, const RasterOutput& out, const RasterOutputGradient& g) {
    alpha[i] = load(out.alpha, i, 0);
    g_alpha[i] = load(g.alpha, i, 0);
    g_depth[i] = load(g.depth_sum, i, 0);
    g_median[i] = load(g.depth_median, i, 0);
    median_behind[i] = max_of(T(0.5f), load(saved.final_transmittance, i, 0));
    remaining[i] = g_alpha[i] * alpha[i] + g_depth[i] * load(out.depth_sum, i, 0);
    for (int c = 0; c < num_channels(); ++c) {
      g_features[c][i] = load(g.features, i, c);
      remaining[i] = fma_of(g_features[c][i], load(out.features, i, c), remaining[i]);
    }
    for (int c = 0; c < 3; ++c) {
      g_normal[c][i] = load(g.normal, i, c);
      remaining[i] = fma_of(g_normal[c][i], load(out.normal, i, c), remaining[i]);
    }
    g_distortion[i] = with_distortion() ? load(g.distortion, i, 0) : T(0);
    if (!with_distortion()) return;
    first_depth[i] = load_pixels<T>(tile, saved.first_depth, i, 0, 1.0f);
    moment1[i] = load(saved.moment1, i, 0);
    moment2[i] = load(saved.moment2, i, 0);
    // sum w dL/dw of the distortion is twice the distortion itself: it is quadratic in w.
    remaining[i] += T(2) * g_distortion[i] * (alpha[i] * moment2[i] - moment1[i] * moment1[i]);
  }

  void begin(TileEntry entry) {
    std::fill_n(sums, slot_width(channels), T(0));
    feature = &tile.input.features[static_cast<std::size_t>(entry.surfel) * channels];
    splat = &tile.lists.splats[entry.surfel];
  }
  void hit(int g, const TileHit<T>& hit) {
    T value = fma_of(g_depth[g], hit.depth, g_alpha[g]);
    for (int c = 0; c < num_channels(); ++c) {
      value = fma_of(g_features[c][g], T(feature[c]), value);
      sums[kSumFeatures + c] = fma_of(hit.weight, g_features[c][g], sums[kSumFeatures + c]);
    }
    for (int c = 0; c < 3; ++c) {
      value = fma_of(g_normal[c][g], T(splat->normal[c]), value);
      sums[kSumNormal + c] = fma_of(hit.weight, g_normal[c][g], sums[kSumNormal + c]);
    }
    // The last hit in front of which more than half of the light is left.
    const auto is_median =
        (hit.transmittance > T(0.5f)) & (hit.transmittance_behind <= median_behind[g]);
    T dL_dz = fma_of(hit.weight, g_depth[g], keep(is_median, g_median[g]));
    if (with_distortion()) add_distortion(g, hit, value, dL_dz);
    remaining[g] = remaining[g] - hit.weight * value;
    const T dL_dalpha = blend_alpha_vjp(hit.transmittance, hit.alpha.alpha, value, remaining[g]);
    add_geometry(hit, keep(hit.valid, dL_dalpha), keep(hit.valid, dL_dz));
  }
  void add_distortion(int g, const TileHit<T>& hit, T& value, T& dL_dz) const {
    const T z = select(hit.valid, hit.depth, T(1));
    const T near(settings.distortion_near), far(settings.distortion_far);
    const T m = distortion_depth(z, first_depth[g], near, far);
    value += g_distortion[g] * distortion_dweight(m, alpha[g], moment1[g], moment2[g]);
    const T dL_dm = g_distortion[g] * distortion_dm(hit.weight, m, alpha[g], moment1[g]);
    dL_dz += distortion_depth_vjp(z, near, far, dL_dm);
  }
  // From alpha and depth of the hit to the sums over the tile.
  void add_geometry(const TileHit<T>& hit, T dL_dalpha, T dL_dz) {
    T dL_drho(0);
    splat_alpha_vjp(T(splat->opacity), hit.alpha, dL_dalpha, sums[kSumOpacity], dL_drho);
    const auto in_plane = hit.valid & hit.in_plane;
    const PlaneHit<T> plane{
        keep(in_plane, hit.plane.u),
        keep(in_plane, hit.plane.v),
        keep(in_plane, hit.plane.t),
        keep(in_plane, hit.plane.inverse)};
    const T scale = dL_drho + dL_drho;  // rho = u^2 + v^2
    Vec3<T> dL_dzeta{};
    intersect_vjp(plane, scale * plane.u, scale * plane.v, dL_dz, dL_dzeta, sums[kSumDet]);
    for (int k = 0; k < 3; ++k) {
      sums[kSumGx + k] = fma_of(dL_dzeta[k], hit.x, sums[kSumGx + k]);
      sums[kSumGy + k] = fma_of(dL_dzeta[k], hit.y, sums[kSumGy + k]);
      sums[kSumG0 + k] += dL_dzeta[k];
    }
    const auto low_pass = hit.valid & !hit.in_plane;
    if (!kLeavesEarly<T> || any(low_pass))
      add_low_pass(hit, keep(low_pass, dL_drho), keep(low_pass, dL_dz));
  }
  void add_low_pass(const TileHit<T>& hit, T dL_drho, T dL_dz) {
    T dL_ddx(0), dL_ddy(0);
    low_pass_rho2_vjp(
        hit.x - T(splat->center_x), hit.y - T(splat->center_y), dL_drho, dL_ddx, dL_ddy
    );
    sums[kSumCenterX] += -dL_ddx;
    sums[kSumCenterY] += -dL_ddy;
    sums[kSumZCenter] += dL_dz;
  }
  float* slot_of(TileEntry entry) const {
    return &saved.pair_gradients[entry.pair * static_cast<std::size_t>(slot_width(channels))];
  }
  void skip(TileEntry entry) { std::fill_n(slot_of(entry), slot_width(channels), 0.0f); }
  void end(TileEntry entry) {
    const int width = slot_width(channels);
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

void sum_pairs(
    const TileLists& lists, std::size_t surfel, const float* slots, int width, float* sums
) {
  std::fill_n(sums, width, 0.0f);
  for (std::uint32_t pair = lists.pair_begin[surfel]; pair < lists.pair_begin[surfel + 1]; ++pair) {
    const float* slot = slots + static_cast<std::size_t>(pair) * width;
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
void store3(std::vector<float>& array, std::size_t i, Vec3<T> v) {
  for (int k = 0; k < 3; ++k) store_strided(&array[3 * i + k], 3, v[k]);
}

// dL/d(image position of the centre) in NDC, the statistic of densification: through the centre
// only.
template <class T>
void store_screen(
    std::vector<float>& screen, std::size_t i, Vec3<T> dL_dm, T z, const CameraOf<T>& c
) {
  const T depth = max_of(z, c.near_plane);
  store_strided(&screen[2 * i], 2, dL_dm.x * depth / c.fx * (T(0.5f) * c.width));
  store_strided(&screen[2 * i + 1], 2, dL_dm.y * depth / c.fy * (T(0.5f) * c.height));
}

template <class T>
void surfel_vjp_lanes(
    const RasterInput& input,
    const CameraOf<float>& camera,
    const RasterSaved& saved,
    std::size_t first,
    RasterGradient& out
) {
  const int width = slot_width(input.channels);
  alignas(32) float sums[8 * kMaxSums];
  float z[8], num_pairs[8];
  for (int i = 0; i < kLanesOf<T>; ++i) {
    sum_pairs(saved.lists, first + i, saved.pair_gradients.data(), width, sums + i * width);
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
  store_screen(out.screen, first, dL_dm, load_lanes<T>(z), c);
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

void check_input(const RasterInput& input, const Camera& camera) {
  GLINT_CHECK(
      input.channels >= 1 && input.channels <= kMaxChannels,
      kUsage,
      "rasterize: {} feature channels, expected 1 to {}",
      input.channels,
      kMaxChannels
  );
  const std::size_t n = input.count;
  const bool sizes_agree = input.means.size() == 3 * n && input.scales.size() == 2 * n &&
                           input.rotations.size() == 4 * n && input.opacities.size() == n &&
                           input.features.size() == n * input.channels;
  GLINT_CHECK(sizes_agree, kUsage, "rasterize: array sizes do not match {} surfels", n);
  GLINT_CHECK(
      input.near_limit.empty() || input.near_limit.size() == camera.size(),
      kUsage,
      "rasterize: near_limit is {}x{}, the camera {}x{}",
      input.near_limit.width,
      input.near_limit.height,
      camera.width,
      camera.height
  );
}

void fit(Image& image, ImageSize size, int channels) {
  if (image.size() != size || image.channels() != channels)
    image = Image(size.width, size.height, channels);
}

void fit_outputs(
    const RasterInput& input,
    const RasterSettings& settings,
    ImageSize size,
    RasterOutput& out,
    RasterSaved& saved
) {
  fit(out.features, size, input.channels);
  fit(out.normal, size, 3);
  for (Image* image : {&out.alpha, &out.depth_sum, &out.depth_median, &saved.final_transmittance})
    fit(*image, size, 1);
  out.visibility.resize(input.count);
  out.in_view.resize(input.count);
  if (settings.with_distortion)
    for (Image* image : {&out.distortion, &saved.first_depth, &saved.moment1, &saved.moment2})
      fit(*image, size, 1);
  else
    out.distortion = Image();
}

}  // namespace

Rasterizer::Rasterizer() : saved_(std::make_unique<RasterSaved>()) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;
Rasterizer& Rasterizer::operator=(Rasterizer&&) noexcept = default;

std::size_t Rasterizer::num_pairs() const { return saved_->lists.num_pairs(); }

std::size_t Rasterizer::num_pixel_pairs() const {
  std::size_t sum = 0;
  for (const PixelBox& box : saved_->lists.boxes)
    if (!box.empty())
      sum += static_cast<std::size_t>(box.x_max - box.x_min) * (box.y_max - box.y_min);
  return sum;
}

void Rasterizer::forward(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings,
    RasterOutput& output,
    bool scalar
) {
  check_input(input, camera);
  TileLists& lists = saved_->lists;
  build_tile_lists(input, camera, settings.near_plane, scalar, lists);
  fit_outputs(input, settings, camera.size(), output, *saved_);
  saved_->pair_visibility.resize(lists.num_pairs());
  dispatch(scalar, input.channels, [&]<class T, int kChannels>() {
    for_each_tile(input, lists, camera.size(), settings.near_plane, [&](const TileContext& tile) {
      forward_tile<T, kChannels>(tile, settings, *saved_, output);
    });
  });
  parallel_for(input.count, 2048, [&](std::size_t i) {
    float sum = 0;
    for (std::uint32_t pair = lists.pair_begin[i]; pair < lists.pair_begin[i + 1]; ++pair)
      sum += saved_->pair_visibility[pair];
    output.visibility[i] = sum;
    output.in_view[i] = lists.boxes[i].empty() ? 0 : 1;
  });
}

void Rasterizer::backward(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings,
    const RasterOutput& output,
    const RasterOutputGradient& dL_doutput,
    RasterGradient& gradient,
    bool scalar
) {
  check_input(input, camera);
  const std::size_t n = input.count;
  gradient.means.resize(3 * n);
  gradient.scales.resize(2 * n);
  gradient.rotations.resize(4 * n);
  gradient.opacities.resize(n);
  gradient.features.resize(n * input.channels);
  gradient.screen.resize(2 * n);
  const TileLists& lists = saved_->lists;
  saved_->pair_gradients.resize(lists.num_pairs() * slot_width(input.channels));
  dispatch(scalar, input.channels, [&]<class T, int kChannels>() {
    for_each_tile(input, lists, camera.size(), settings.near_plane, [&](const TileContext& tile) {
      backward_tile<T, kChannels>(tile, settings, *saved_, output, dL_doutput);
    });
  });
  surfel_vjp(input, camera, settings.near_plane, *saved_, scalar, gradient);
}

}  // namespace glint
