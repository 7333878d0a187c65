// SPDX-License-Identifier: MIT
#include "datasets/glassroom/path_tracer.h"

#include <algorithm>

#include "datasets/glassroom/fresnel.h"
#include "datasets/glassroom/layers.h"
#include "datasets/glassroom/path_integrator.h"
#include "glint/core/error.h"
#include "glint/core/interrupt.h"
#include "glint/core/parallel.h"

namespace glint {

using namespace path_tracing;

struct PathTracer::State {
  explicit State(const TraceScene& scene) : rays(scene), lights(rays) {}
  RayScene rays;
  LightSampler lights;
};

namespace {

// Branches of sampler.h's pixel_key.
constexpr std::uint64_t kCameraBranch = 0, kReflectionBranch = 1;

void store(Image& image, int x, int y, Vec3d value) {
  float* out = image.pixel(x, y);
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(value[c]);
}

// In the order of PathKind.
constexpr std::array<MapId, kNumPathKinds> kPathMaps{
    "path_t", "path_tt", "path_r", "path_tr", "path_rt", "path_rest"};

// Of the samples of a pixel.
struct RadianceSums {
  Vec3d transmitted{}, reflected{};
  std::array<Vec3d, kNumPathKinds> kinds{};

  void add(const PathIntegrator::Split& sample) {
    transmitted += cast<double>(sample.transmitted);
    reflected += cast<double>(sample.reflected);
    kinds[static_cast<std::size_t>(sample.transmitted_kind)] += cast<double>(sample.transmitted);
    kinds[static_cast<std::size_t>(sample.reflected_kind)] += cast<double>(sample.reflected);
  }
};

// One image in the making: its pixels are independent.
class Rendering {
 public:
  Rendering(
      const RayScene& rays,
      const LightSampler& lights,
      const Camera& camera,
      const PathTracerSettings& settings,
      PathTracerOutput& out
  )
      : rays_(rays),
        integrator_(rays, lights, {settings.max_bounces, settings.next_event_estimation}),
        camera_(camera),
        settings_(settings),
        out_(out),
        origin_(cast<float>(camera.center())) {}

  void row(int y) const {
    for (int x = 0; x < camera_.width; ++x) pixel(x, y);
  }

 private:
  void pixel(int x, int y) const {
    geometry(x, y);
    radiance(x, y);
  }

  Vec3f ray_direction(double x, double y) const { return cast<float>(camera_.ray_in_world(x, y)); }

  void geometry(int x, int y) const {
    const Vec3f direction = ray_direction(x + 0.5, y + 0.5);
    const auto first = rays_.intersect(origin_, direction, RayMask::kAll);
    if (!first) return;
    write_layer(*first, x, y, out_.maps["depth"], out_.maps["normal"]);
    const bool glass = rays_.is_glass(*first);
    const MaterialKind kind = rays_.material(*first).kind;
    const bool metal = kind == MaterialKind::kRoughConductor || kind == MaterialKind::kMirror;
    out_.maps["glass"].at(x, y) = glass ? 1.0f : 0.0f;
    const Vec3f color = glass ? rays_.material(*first).tint : rays_.albedo(*first);
    store(out_.maps["basecolor"], x, y, cast<double>(color));
    if (!glass && !metal) store(out_.maps["albedo"], x, y, cast<double>(color));
    const auto behind = glass ? rays_.intersect(origin_, direction, RayMask::kOpaque) : first;
    if (behind) write_layer(*behind, x, y, out_.maps["behind_depth"], out_.maps["behind_normal"]);
    if (settings_.layers) further_layers(x, y, direction);
  }

  void further_layers(int x, int y, Vec3f direction) const {
    const auto [layers, count] = layers_along(rays_, origin_, direction);
    out_.maps["layer_1_mirror"].at(x, y) = layers[0].mirror ? 1.0f : 0.0f;
    for (std::size_t k = 1; k < count; ++k) {
      const Vec3d n = camera_.rotation_cam_from_world * layers[k].normal;
      out_.maps[kLayerDepth[k]].at(x, y) = static_cast<float>(camera_.to_cam(layers[k].position).z);
      store(out_.maps[kLayerNormal[k]], x, y, normalize(n));
      out_.maps[kLayerGlass[k]].at(x, y) = layers[k].glass ? 1.0f : 0.0f;
      out_.maps[kLayerMirror[k]].at(x, y) = layers[k].mirror ? 1.0f : 0.0f;
    }
  }

  void write_layer(const Surface& surface, int x, int y, Image& depth, Image& normal) const {
    depth.at(x, y) = static_cast<float>(camera_.to_cam(cast<double>(surface.position)).z);
    const Vec3d n = camera_.rotation_cam_from_world * cast<double>(surface.shading_normal);
    store(normal, x, y, normalize(n));
  }

  void radiance(int x, int y) const {
    const std::uint64_t pixel = static_cast<std::uint64_t>(y) * camera_.width + x;
    const std::uint64_t key = pixel_key(settings_.seed, settings_.view, pixel, kCameraBranch);
    const std::uint64_t mirror_key =
        pixel_key(settings_.seed, settings_.view, pixel, kReflectionBranch);
    RadianceSums total;
    std::array<RadianceSums, 2> halves;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(settings_.spp); ++i) {
      Sampler sampler(key, i), mirror_sampler(mirror_key, i);
      const Vec2f u = sampler.next_2d();
      const Vec3f direction = normalize(ray_direction(x + double(u.x), y + double(u.y)));
      const auto sample = integrator_.radiance(origin_, direction, sampler, mirror_sampler);
      total.add(sample);
      halves[i < first_half() ? 0 : 1].add(sample);
    }
    write_radiance(x, y, total, settings_.spp, out_.radiance, out_.maps);
    if (out_.halves[0].empty()) return;
    const int first = static_cast<int>(first_half());
    for (const std::size_t h : {0u, 1u})
      write_radiance(
          x,
          y,
          halves[h],
          h == 0 ? first : settings_.spp - first,
          out_.halves[h]["rgb"],
          out_.halves[h]
      );
  }
  std::uint32_t first_half() const { return static_cast<std::uint32_t>(settings_.spp) / 2; }

  // The sum is taken in float, so that it holds exactly between the images.
  void write_radiance(
      int x, int y, const RadianceSums& sums, int count, Image& radiance, MapSet& maps
  ) const {
    const double share = 1.0 / count;
    const Vec3f t = cast<float>(share * sums.transmitted), r = cast<float>(share * sums.reflected);
    store(radiance, x, y, cast<double>(t + r));
    const bool glass = out_.maps["glass"].at(x, y) != 0;
    if (glass) {
      store(maps["transmitted"], x, y, cast<double>(t));
      store(maps["reflected"], x, y, cast<double>(r));
    }
    if (!settings_.layers || !(glass || out_.maps["layer_1_mirror"].at(x, y) != 0)) return;
    for (std::size_t k = 0; k < kPathMaps.size(); ++k)
      store(maps[kPathMaps[k]], x, y, share * sums.kinds[k]);
  }

  const RayScene& rays_;
  PathIntegrator integrator_;
  const Camera& camera_;
  const PathTracerSettings& settings_;
  PathTracerOutput& out_;
  Vec3f origin_;
};

constexpr MapId kTracedMaps[] = {
    "depth",
    "normal",
    "glass",
    "behind_depth",
    "behind_normal",
    "transmitted",
    "reflected",
    "albedo",
    "basecolor"};

void add_layer_maps(PathTracerOutput& out, const PathTracerSettings& settings) {
  const int w = out.radiance.width(), h = out.radiance.height();
  const auto add = [&](MapSet& maps, MapId id) { maps[id] = Image(w, h, id.row().channels()); };
  add(out.maps, "layer_1_mirror");
  for (std::size_t k = 1; k < kMaxLayers; ++k)
    for (const MapId id : {kLayerDepth[k], kLayerNormal[k], kLayerGlass[k], kLayerMirror[k]})
      add(out.maps, id);
  for (const MapId id : kPathMaps) add(out.maps, id);
  if (settings.spp < 2) return;
  for (MapSet& half : out.halves) {
    for (const MapId id : {MapId("rgb"), MapId("transmitted"), MapId("reflected")}) add(half, id);
    for (const MapId id : kPathMaps) add(half, id);
  }
}

PathTracerOutput empty_output(const Camera& camera, const PathTracerSettings& settings) {
  const int w = camera.width, h = camera.height;
  PathTracerOutput out{Image(w, h, 3), {}, {}};
  for (const MapId id : kTracedMaps) out.maps[id] = Image(w, h, id.row().channels());
  if (settings.layers) add_layer_maps(out, settings);
  return out;
}

}  // namespace

PathTracer::PathTracer(const TraceScene& scene) : state_(std::make_unique<State>(scene)) {}
PathTracer::~PathTracer() = default;

PathTracerOutput PathTracer::render(const Camera& camera, const PathTracerSettings& settings)
    const {
  GLINT_CHECK(
      camera.width > 0 && camera.height > 0 && camera.fx > 0 && camera.fy > 0,
      kUsage,
      "path tracer: camera of {} x {} pixels, focal lengths {} and {}; all must be positive",
      camera.width,
      camera.height,
      camera.fx,
      camera.fy
  );
  GLINT_CHECK(settings.spp > 0, kUsage, "path tracer: {} samples a pixel", settings.spp);
  GLINT_CHECK(
      settings.max_bounces >= 0, kUsage, "path tracer: max_bounces is {}", settings.max_bounces
  );
  PathTracerOutput out = empty_output(camera, settings);
  const Rendering rendering(state_->rays, state_->lights, camera, settings, out);
  parallel_for(static_cast<std::size_t>(camera.height), 1, [&](std::size_t row) {
    throw_if_interrupted();
    rendering.row(static_cast<int>(row));
  });
  return out;
}

PathTracer::FirstHit PathTracer::first_hit(Vec3f origin, Vec3f direction, bool skip_glass) const {
  const RayScene& rays = state_->rays;
  const auto surface =
      rays.intersect(origin, direction, skip_glass ? RayMask::kOpaque : RayMask::kAll);
  if (!surface) return {};
  const bool glass = rays.is_glass(*surface);
  return {
      true,
      surface->t,
      surface->position,
      surface->normal,
      glass ? Vec3f{} : rays.albedo(*surface),
      surface->mesh,
      glass,
      rays.is_mirror(*surface)};
}

bool PathTracer::occluded(Vec3f from, Vec3f to) const { return state_->rays.occluded(from, to); }

float thin_slab_reflectance(float cos_i, float ior) {
  const PolarizedReflectance r = fresnel_dielectric_polarized(std::clamp(cos_i, 0.0f, 1.0f), ior);
  return r.s / (1 + r.s) + r.p / (1 + r.p);  // mean of 2r / (1 + r)
}

}  // namespace glint
