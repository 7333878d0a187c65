// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>
#include <memory>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/op_backends.h"
#include "glint/render/tile_kernel.h"

namespace glint {

namespace {

// What backward needs of forward; reused between calls.
struct RasterSaved {
  std::shared_ptr<const TileLists> shared_lists;  // those of this pass or of the first of several
  const TileLists& lists() const { return *shared_lists; }
  KeptMaps<ImageMap> kept;
  // Of each pair, in the order of TileLists::entries.
  std::vector<float> pair_visibility;
  std::vector<float> pair_owned;  // pixels of the tile that the surfel owns, or empty
  // Blocks of the tile where a pixel has a hit, one bit each: backward looks at no others.
  std::vector<std::uint8_t> pair_blocks;
  std::vector<float> pair_gradients;  // [pairs][slot_width]

  // Calls f(place) for the pairs of a surfel.
  template <class F>
  void for_pairs(std::size_t surfel, F&& f) const {
    for (std::uint32_t pair = lists().pair_begin[surfel]; pair < lists().pair_begin[surfel + 1];
         ++pair)
      f(lists().places[pair]);
  }
};

// ---- forward -----------------------------------------------------------------------------------

template <class T, class Code>
struct ForwardVisitor {
  const TileContext& tile;
  const DistortionRange range;
  RasterSaved& saved;
  PixelSums<T, Code> sums[kGroupsPerTile<T>];
  T visibility, owned;
  unsigned blocks;
  const float* feature;
  const Splat* splat;

  ForwardVisitor(const TileContext& tile, RasterSaved& saved)
      : tile(tile), range(distortion_range(tile.call.settings)), saved(saved) {
    for (auto& group : sums) group.clear();
  }

  MapChannels has() const { return Code::known(tile.has); }
  std::uint64_t groups(std::uint32_t place) const {
    return groups_of_blocks<T>(blocks_of(tile, tile.lists.boxes[tile.lists.entries[place]]));
  }
  void begin(std::uint32_t surfel) {
    visibility = owned = T(0);
    blocks = 0;
    feature = tile.feature(surfel);
    splat = &tile.lists.splats[surfel];
  }
  SplatHit<T> room_for_hit() const {  // of its own, in registers
    SplatHit<T> hit;
    return hit;
  }
  void hit(int g, const SplatHit<T>& hit) {
    visibility += hit.weight;
    const bool counts = any(hit.transmittance_behind < hit.transmittance);  // or stops a pixel
    blocks |= static_cast<unsigned>(counts) << (g / kGroupsPerBlock<T>);
    if (has().statistics) owned += keep(owns_pixel(hit), T(1));
    sums[g].add(hit, *splat, feature, has(), range);
  }
  void end(std::uint32_t place) {
    saved.pair_visibility[place] = lane_sum(visibility);
    if (has().statistics) saved.pair_owned[place] = lane_sum(owned);
    saved.pair_blocks[place] = static_cast<std::uint8_t>(blocks);
  }
  void skip(std::uint32_t place) {
    saved.pair_visibility[place] = 0;
    if (has().statistics) saved.pair_owned[place] = 0;
    saved.pair_blocks[place] = 0;
  }

  void store(const TilePixels<T>& pixels, RasterOutput& out) {
    for (int g = 0; g < kGroupsPerTile<T>; ++g) {
      sums[g].finish(pixels.final_transmittance(g), range);
      const auto store_map = [&](int width, const T* values, Image& map) {
        if (width > 0) store_pixels(tile, map.ref(), g, width, values);
      };
      for_each_map(
          has(),
          [&](const char*, int width, const T* values, Image& map) {
            store_map(width, values, map);
          },
          sums[g].maps,
          out
      );
      for_each_kept_map(
          has(),
          [&](int width, float, const T* values, Image& map) { store_map(width, values, map); },
          sums[g].kept,
          saved.kept
      );
    }
  }
};

template <class T, class Code>
void forward_tile(const TileContext& tile, RasterSaved& saved, RasterOutput& out) {
  TilePixels<T> pixels(tile);
  ForwardVisitor<T, Code> visitor(tile, saved);
  for_each_hit(tile, pixels, visitor);
  visitor.store(pixels, out);
}

// ---- backward ----------------------------------------------------------------------------------

constexpr int kMaxSums = in_eights(feature_slot(true, true) + kMaxChannels);

template <class T, class Code>
struct BackwardVisitor {
  const TileContext& tile;
  const DistortionRange range;
  RasterSaved& saved;
  PixelGradient<T, Code> pixels[kGroupsPerTile<T>];

  BackwardVisitor(
      const TileContext& tile,
      RasterSaved& saved,
      const RasterOutput& out,
      const RasterOutputGradient& dL_dout
  )
      : tile(tile), range(distortion_range(tile.call.settings)), saved(saved) {
    for (int g = 0; g < kGroupsPerTile<T>; ++g) load_group(g, out, dL_dout);
  }

  void load(const Image& map, int group, int width, float outside, T* values) const {
    if (map.empty())
      std::fill_n(values, width, T(0));
    else if (width > 0)
      load_pixels(tile, map.view(), group, width, outside, values);
  }
  void load_group(int g, const RasterOutput& out, const RasterOutputGradient& dL_dout) {
    PixelMaps<T, Code> maps;
    for_each_map(
        has(),
        [&](const char*, int width, T* dL, T* values, const Image& dL_dmap, const Image& map) {
          load(dL_dmap, g, width, 0.0f, dL);
          load(map, g, width, 0.0f, values);
        },
        pixels[g].dL,
        maps,
        dL_dout,
        out
    );
    for_each_kept_map(
        has(),
        [&](int width, float empty, T* values, const Image& map) {
          load(map, g, width, empty, values);
        },
        pixels[g].kept,
        saved.kept
    );
    pixels[g].start(maps, has());
  }

  MapChannels has() const { return Code::known(tile.has); }
  std::uint64_t groups(std::uint32_t place) const {
    return groups_of_blocks<T>(saved.pair_blocks[place]);
  }
  // Hits wait until there are some, and are then worked on step by step: a step of one hit does not
  // wait for that of another, as all steps of one do.
  void begin(std::uint32_t) {}
  SplatHit<T>& room_for_hit() { return hits[num_hits]; }
  void hit(int g, const SplatHit<T>&) { groups_of_hits[num_hits++] = g; }
  void skip(std::uint32_t) {}  // sum_pairs() leaves out pairs without blocks
  void end(std::uint32_t place) {
    places[num_places] = place;
    ends[num_places++] = num_hits;
    if (num_hits > kRoom - kGroupsPerTile<T>) finish();
  }
  // What waits.
  void finish() {
    for_waiting([&](std::uint32_t place, int begin, int end) { go_through(place, begin, end); });
    for_waiting([&](std::uint32_t place, int begin, int end) { sum_up(place, begin, end); });
    num_hits = num_places = 0;
  }

 private:
  using Gradient = PixelGradient<T, Code>;

  // Calls f(place, its first hit, one past its last).
  template <class F>
  void for_waiting(F&& f) const {
    for (int p = 0; p < num_places; ++p) f(places[p], p == 0 ? 0 : ends[p - 1], ends[p]);
  }
  const Splat& splat_of(std::uint32_t place) const {
    return tile.lists.splats[tile.lists.entries[place]];
  }
  void go_through(std::uint32_t place, int begin, int end) {
    const Splat& splat = splat_of(place);
    const float* feature = tile.feature(tile.lists.entries[place]);
    for (int i = begin; i < end; ++i)
      gradients[i] = pixels[groups_of_hits[i]].through(hits[i], splat, feature, has(), range);
  }
  void sum_up(std::uint32_t place, int begin, int end) {
    const Splat& splat = splat_of(place);
    T sums[Code::kSums];
    std::fill_n(sums, splat_sums(has()), T(0));
    // A loop for each: with a surface a little faster than one (docs/PERFORMANCE.md).
    for (int i = begin; i < end; ++i)
      pixels[groups_of_hits[i]].add_attributes(hits[i], splat, has(), sums);
    for (int i = begin; i < end; ++i)
      Gradient::add_alpha(hits[i], gradients[i], splat, has(), sums);
    for (int i = begin; i < end; ++i) Gradient::add_geometry(hits[i], gradients[i], splat, sums);
    store(place, sums);
  }
  void store(std::uint32_t place, const T* sums) {
    const int width = splat_sums(has());
    float* slot = &saved.pair_gradients[place * static_cast<std::size_t>(width)];
    if constexpr (kLanesOf<T> == 8)
      for (int i = 0; i < width; i += 8) lane_sums(&sums[i]).store(slot + i);
    else
      for (int i = 0; i < width; ++i) slot[i] = sums[i];
  }

  static constexpr int kRoom = 2 * kGroupsPerTile<T>;
  int num_hits = 0, num_places = 0;  // that wait
  SplatHit<T> hits[kRoom];
  HitGradient<T> gradients[kRoom];
  int groups_of_hits[kRoom];
  std::uint32_t places[kRoom];
  int ends[kRoom];  // of the hits of each place
};

template <class T, class Code>
void backward_tile(
    const TileContext& tile,
    RasterSaved& saved,
    const RasterOutput& out,
    const RasterOutputGradient& dL_dout
) {
  TilePixels<T> pixels(tile);
  BackwardVisitor<T, Code> visitor(tile, saved, out, dL_dout);
  for_each_hit(tile, pixels, visitor);
  visitor.finish();
}

// Calls body<T, Code>(tile) for every tile, with the lane type and PassCode of the call.
template <class F>
void for_each_tile(const RasterCall& call, const TileLists& lists, F&& body) {
  const auto with_lanes = [&](auto lane) {
    with_pass_code(call.maps(), [&]<class Code>() {
      parallel_for(lists.num_tiles(), 2, [&](std::size_t i) {
        const int tile = static_cast<int>(i);
        body.template operator()<decltype(lane), Code>(TileContext{
            call,
            lists,
            call.camera.size(),
            tile % lists.tiles_x,
            tile / lists.tiles_x,
            call.maps()});
      });
    });
  };
  call.settings.scalar ? with_lanes(0.0f) : with_lanes(Float8(0.0f));
}

// ---- sums over a surfel's tiles ----------------------------------------------------------------

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
  project_surfel_vjp(surfel, c, projected_gradient<T>(has, sum), g, dL_dm);
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
    if (!call.settings.scalar)
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
  bool scalar = false;

  ListedCall() = default;
  explicit ListedCall(const RasterCall& call)
      : means(call.input.means.data()),
        scales(call.input.scales.data()),
        rotations(call.input.rotations.data()),
        opacities(call.input.opacities.data()),
        count(call.input.count),
        camera(camera_of(call)),
        scalar(call.settings.scalar) {}
  friend bool operator==(const ListedCall& a, const ListedCall& b) {
    return a.means == b.means && a.scales == b.scales && a.rotations == b.rotations &&
           a.opacities == b.opacities && a.count == b.count && a.scalar == b.scalar &&
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
    for_each_tile(call, saved_.lists(), [&]<class T, class Code>(const TileContext& tile) {
      forward_tile<T, Code>(tile, saved_, output);
    });
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
    for_each_tile(call, saved_.lists(), [&]<class T, class Code>(const TileContext& tile) {
      backward_tile<T, Code>(tile, saved_, output, dL_doutput);
    });
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

std::unique_ptr<RasterBackend> raster_on_cpu() { return std::make_unique<RasterOnCpu>(); }

}  // namespace glint
