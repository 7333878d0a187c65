// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/op_backends.h"
#include "glint/render/raster_wide.h"

namespace glint {

namespace {

// How many pixels are taken at once.
int lanes_of(const RasterSettings& settings) {
  if (settings.lanes >= 16 && has_wide_tiles()) return 16;
  return settings.lanes >= 8 ? 8 : 1;
}

// Calls wide(tile) or body<T, Code>(tile) for every tile, with the lanes and the PassCode of the
// call.
template <class Wide, class F>
void for_each_tile(const RasterCall& call, const TileLists& lists, Wide&& wide, F&& body) {
  const ImageView near_limit = call.input.near_limit.view();
  const auto run = [&](auto&& of_tile) {
    parallel_for(lists.num_tiles(), 2, [&](std::size_t i) {
      const int tile = static_cast<int>(i);
      of_tile(TileContext{
          call,
          lists,
          call.camera.size(),
          tile % lists.tiles_x,
          tile / lists.tiles_x,
          call.maps(),
          near_limit});
    });
  };
  const auto with_lanes = [&](auto lane) {
    with_pass_code(call.maps(), [&]<class Code>() {
      run([&](const TileContext& tile) { body.template operator()<decltype(lane), Code>(tile); });
    });
  };
  const int lanes = lanes_of(call.settings);
  if (lanes == 16) return run(wide);
  lanes == 1 ? with_lanes(0.0f) : with_lanes(Float8(0.0f));
}

// ---- sums over a surfel's tiles ----------------------------------------------------------------

constexpr int kMaxSums = in_eights(feature_slot(true, true) + kMaxChannels);

void sum_pairs(const RasterSaved& saved, std::size_t surfel, int width, float* sums) {
  std::fill_n(sums, width, 0.0f);
  saved.for_pairs(surfel, [&](std::uint32_t place) {
    if (saved.pair_blocks[place] == 0) return;
    const float* slot = &saved.pair_gradients[static_cast<std::size_t>(place) * width];
    for (int i = 0; i < width; i += 8)
      (Float8::load(sums + i) + Float8::load(slot + i)).store(sums + i);
  });
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

// |dL/d(screen)| from pixels to NDC.
void store_screen_abs(const float* sums, ImageSize size, std::size_t i, RasterGradient& out) {
  const float* s = sums + kSumScreenAbsX;
  out.screen_abs[2 * i] = 0.5f * static_cast<float>(size.width) * s[0];
  out.screen_abs[2 * i + 1] = 0.5f * static_cast<float>(size.height) * s[1];
}

template <class T>
void surfel_vjp_lanes(
    const RasterCall& call,
    const CameraOf<float>& camera,
    const RasterSaved& saved,
    std::size_t first,
    RasterGradient& out
) {
  const RasterInput& input = call.input;
  const MapChannels has = call.maps();
  const int width = splat_sums(has);
  alignas(32) float sums[8 * kMaxSums];
  float z[8], num_pairs[8];
  for (int i = 0; i < kLanesOf<T>; ++i) {
    sum_pairs(saved, first + i, width, sums + i * width);
    std::copy_n(
        sums + i * width + feature_slot(has),
        input.channels,
        &out.features[(first + i) * input.channels]
    );
    out.opacities[first + i] = sums[i * width + kSumOpacity];
    if (has.statistics) store_screen_abs(sums + i * width, call.camera.size(), first + i, out);
    num_pairs[i] = static_cast<float>(saved.lists().boxes[first + i].num_tiles());
    z[i] = num_pairs[i] > 0 ? saved.lists().splats[first + i].z_center : 1.0f;
  }
  const CameraOf<T> c = broadcast_camera<T>(camera);
  const SurfelGeometry<T> surfel = load_geometry<T>(input, first);
  SurfelGeometry<T> g{};
  Vec3<T> dL_dm;
  const auto sum = [&](int slot) { return load_strided<T>(sums + slot, width); };
  project_surfel_vjp(
      surfel, c, projected_gradient<T>(has, sum), call.settings.screen_with_low_pass, g, dL_dm
  );
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

void surfel_vjp(const RasterCall& call, const RasterSaved& saved, RasterGradient& out) {
  const CameraOf<float> camera = camera_of(call);
  parallel_for_blocks(call.input.count, 512, [&](std::size_t begin, std::size_t end) {
    std::size_t i = begin;
    if (call.settings.lanes > 1)
      for (; i + 8 <= end; i += 8) surfel_vjp_lanes<Float8>(call, camera, saved, i, out);
    for (; i < end; ++i) surfel_vjp_lanes<float>(call, camera, saved, i, out);
  });
}

void fit_saved(const RasterCall& call, RasterSaved& saved) {
  saved.pair_visibility.resize(saved.lists().num_pairs());
  saved.pair_blocks.resize(saved.lists().num_pairs());
  saved.pair_owned.resize(call.settings.with_statistics ? saved.lists().num_pairs() : 0);
  for_each_kept_map(
      call.maps(),
      [&](int channels, float, Image& map) {
        if (channels > 0) fit(map, call.camera.size(), channels);
      },
      saved.kept
  );
}

// Per surfel, in the order of its pairs.
void sum_visibility(const RasterSaved& saved, RasterOutput& output) {
  const TileLists& lists = saved.lists();
  parallel_for(lists.boxes.size(), 2048, [&](std::size_t i) {
    float sum = 0;
    saved.for_pairs(i, [&](std::uint32_t place) { sum += saved.pair_visibility[place]; });
    output.visibility[i] = sum;
    output.in_view[i] = lists.boxes[i].empty() ? 0 : 1;
  });
}

void sum_statistics(const RasterCall& call, const RasterSaved& saved, RasterOutput& output) {
  const TileLists& lists = saved.lists();
  const CameraOf<float> camera = camera_of(call);
  parallel_for(output.radii.size(), 2048, [&](std::size_t i) {
    float owned = 0;
    saved.for_pairs(i, [&](std::uint32_t place) { owned += saved.pair_owned[place]; });
    output.owned_pixels[i] = owned;
    output.radii[i] =
        lists.boxes[i].empty()
            ? 0.0f
            : screen_radius(
                  load_geometry<float>(call.input, i), camera, max_rho_of(call.input.opacities[i])
              );
  });
}

// What lists are made of.
struct ListedCall {
  const float *means = nullptr, *scales = nullptr, *rotations = nullptr, *opacities = nullptr;
  std::size_t count = 0;
  CameraOf<float> camera{};
  bool with_lanes = false;

  ListedCall() = default;
  explicit ListedCall(const RasterCall& call)
      : means(call.input.means.data()),
        scales(call.input.scales.data()),
        rotations(call.input.rotations.data()),
        opacities(call.input.opacities.data()),
        count(call.input.count),
        camera(camera_of(call)),
        with_lanes(call.settings.lanes > 1) {}
  friend bool operator==(const ListedCall& a, const ListedCall& b) {
    return a.means == b.means && a.scales == b.scales && a.rotations == b.rotations &&
           a.opacities == b.opacities && a.count == b.count && a.with_lanes == b.with_lanes &&
           std::memcmp(&a.camera, &b.camera, sizeof a.camera) == 0;
  }
};

class RasterOnCpu final : public RasterBackend {
 public:
  void forward(const RasterCall& call, RasterOutput& output, RasterBackend* first) override {
    const auto* other = static_cast<const RasterOnCpu*>(first);
    const ListedCall listed(call);
    const bool share = other != nullptr && other != this && other->listed_ == listed;
    listed_ = listed;
    if (!share) build_tile_lists(call, *own_lists_);
    saved_.shared_lists = share ? other->saved_.shared_lists : own_lists_;
    fit_saved(call, saved_);
    for_each_tile(
        call,
        saved_.lists(),
        [&](const TileContext& tile) { kWideTiles.forward(tile, saved_, output); },
        [&]<class T, class Code>(const TileContext& tile) {
          forward_tile<T, Code>(tile, saved_, output);
        }
    );
    sum_visibility(saved_, output);
    sum_statistics(call, saved_, output);
  }
  void backward(
      const RasterCall& call,
      const RasterOutput& output,
      const RasterOutputGradient& dL_doutput,
      RasterGradient& gradient
  ) override {
    const std::size_t pairs = saved_.lists().num_pairs();
    saved_.pair_gradients.resize(pairs * splat_sums(call.maps()));
    for_each_tile(
        call,
        saved_.lists(),
        [&](const TileContext& tile) { kWideTiles.backward(tile, saved_, output, dL_doutput); },
        [&]<class T, class Code>(const TileContext& tile) {
          backward_tile<T, Code>(tile, saved_, output, dL_doutput);
        }
    );
    surfel_vjp(call, saved_, gradient);
  }
  void first_surface(
      const RasterCall& call,
      const RasterOutput& output,
      const Image& mask,
      const FirstSurfaceSettings& settings,
      Image& depth
  ) override {
    first_surface_on_cpu(call, saved_.lists(), output, mask, settings, depth);
  }
  void depth_modes(
      const RasterCall& call, const DepthModeSettings& settings, Image& first, Image& last
  ) override {
    depth_modes_on_cpu(call, saved_.lists(), settings, first, last);
  }
  std::size_t num_pairs() override { return saved_.lists().num_pairs(); }
  std::size_t num_pixel_pairs() override {
    std::size_t sum = 0;
    for (const PixelBox& box : saved_.lists().boxes) sum += box.num_pixels();
    return sum;
  }

 private:
  std::shared_ptr<TileLists> own_lists_ = std::make_shared<TileLists>();
  ListedCall listed_;  // the last one
  RasterSaved saved_;
};

}  // namespace

// A pixel is not where nobody looks at it, nor where its limit says that nothing counts: a mirrored
// camera's tiles beside its mirror have no such pixel.
bool TileContext::is_needed() const {
  constexpr float kNever = 1e30f;  // metres; no hit is as far
  const ImageView needed = call.input.needed.view();
  if (needed.empty() && near_limit.empty()) return true;
  for (int y = y0(); y < std::min(y0() + kTileSize, size.height); ++y)
    for (int x = x0(); x < std::min(x0() + kTileSize, size.width); ++x) {
      const bool looked_at = needed.empty() || needed.at(x, y) != 0;
      if (looked_at && (near_limit.empty() || near_limit.at(x, y) < kNever)) return true;
    }
  return false;
}

// What the wide tiles use of arrays and do not define.
template class Array<float>;
template class BasicImage<float>;

bool has_wide_tiles() {
  static const bool has = [] {
    const char* most = std::getenv("GLINT_LANES");
    return kWideTiles.forward != nullptr && (most == nullptr || std::atoi(most) >= 16) &&
           __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
  }();
  return has;
}

std::unique_ptr<RasterBackend> raster_on_cpu() { return std::make_unique<RasterOnCpu>(); }

}  // namespace glint
