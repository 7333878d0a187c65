// SPDX-License-Identifier: MIT
#include "datasets/glassroom/path_tracer.h"

#include <algorithm>

#include "datasets/glassroom/fresnel.h"
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
    const bool conductor = rays_.material(*first).kind == MaterialKind::kRoughConductor;
    out_.maps["glass"].at(x, y) = glass ? 1.0f : 0.0f;
    const Vec3f color = glass ? rays_.material(*first).tint : rays_.albedo(*first);
    store(out_.maps["basecolor"], x, y, cast<double>(color));
    if (!glass && !conductor) store(out_.maps["albedo"], x, y, cast<double>(color));
    const auto behind = glass ? rays_.intersect(origin_, direction, RayMask::kOpaque) : first;
    if (behind) write_layer(*behind, x, y, out_.maps["behind_depth"], out_.maps["behind_normal"]);
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
    Vec3d transmitted{}, reflected{};
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(settings_.spp); ++i) {
      Sampler sampler(key, i), mirror_sampler(mirror_key, i);
      const Vec2f u = sampler.next_2d();
      const Vec3f direction = normalize(ray_direction(x + double(u.x), y + double(u.y)));
      const auto sample = integrator_.radiance(origin_, direction, sampler, mirror_sampler);
      transmitted += cast<double>(sample.transmitted);
      reflected += cast<double>(sample.reflected);
    }
    write_radiance(x, y, (1.0 / settings_.spp) * transmitted, (1.0 / settings_.spp) * reflected);
  }

  // The sum is taken in float, so that it holds exactly between the images.
  void write_radiance(int x, int y, Vec3d transmitted, Vec3d reflected) const {
    const Vec3f t = cast<float>(transmitted), r = cast<float>(reflected);
    store(out_.radiance, x, y, cast<double>(t + r));
    if (out_.maps["glass"].at(x, y) == 0) return;
    store(out_.maps["transmitted"], x, y, cast<double>(t));
    store(out_.maps["reflected"], x, y, cast<double>(r));
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

PathTracerOutput empty_output(int w, int h) {
  PathTracerOutput out{Image(w, h, 3), {}};
  for (const MapId id : kTracedMaps) out.maps[id] = Image(w, h, id.row().channels());
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
  PathTracerOutput out = empty_output(camera.width, camera.height);
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
      glass};
}

bool PathTracer::occluded(Vec3f from, Vec3f to) const { return state_->rays.occluded(from, to); }

float thin_slab_reflectance(float cos_i, float ior) {
  const PolarizedReflectance r = fresnel_dielectric_polarized(std::clamp(cos_i, 0.0f, 1.0f), ior);
  return r.s / (1 + r.s) + r.p / (1 + r.p);  // mean of 2r / (1 + r)
}

}  // namespace glint
