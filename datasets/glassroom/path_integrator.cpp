// SPDX-License-Identifier: MIT
#include "datasets/glassroom/path_integrator.h"

#include <algorithm>
#include <cmath>

#include "datasets/glassroom/path_tracer.h"

namespace glint::path_tracing {

namespace {

constexpr int kRouletteStart = 3;  // bounces before Russian roulette
constexpr float kMaxSurvival = 0.95f;
// A straight line through more panes than this is cut: it bounds the loop, not the picture.
constexpr int kMaxPanes = 1000;

// Power heuristic with exponent 2, [Veach97] Eq. 9.13, of a strategy against one other.
float power_heuristic(float pdf, float other) {
  const float p2 = pdf * pdf, q2 = other * other;
  return p2 / (p2 + q2);
}

float max_component(Vec3f v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

// A path under way: its next segment and what it carries.
struct PathIntegrator::Path {
  Vec3f origin, direction;  // unit
  Vec3f throughput{1, 1, 1};
  int bounces = 0, panes = 0;
  // Of the last vertex with a finite density: that density, and the distance come since along the
  // straight line. 0: the camera or a mirror, which next-event estimation cannot serve.
  float pdf = 0, distance = 0;

  bool alive(int max_bounces) const {
    return max_component(throughput) > 0 && bounces <= max_bounces && panes < kMaxPanes;
  }
  void reflect(const Surface& surface) {
    direction = mirrored(direction, surface.normal);
    origin = RayScene::leave(surface.position, surface.normal, direction);
    pdf = 0;
    ++bounces;
  }
  void pass(const Surface& surface) {
    origin = RayScene::leave(surface.position, surface.normal, direction);
    distance += surface.t;
    ++panes;
  }
  void continue_from(const Surface& surface, Vec3f wi, Vec3f carried, float density) {
    direction = wi;
    origin = RayScene::leave(surface.position, surface.normal, wi);
    throughput = carried;
    pdf = density;
    distance = 0;
  }
};

// From where a path came to an opaque vertex.
struct PathIntegrator::Arrival {
  Arrival(const Surface& surface, Vec3f direction)
      : frame(surface.shading_normal), wo(frame.to_local(-direction)) {}
  Frame frame;
  Vec3f wo;  // local, towards the path's origin
};

// What a light sends to a vertex: nothing where `passed` is 0.
struct PathIntegrator::Illumination {
  Vec3f wi{};        // local, towards the light
  Vec3f passed{};    // transmittance of what is between
  Vec3f radiance{};  // of the light
  float pdf = 0;     // of the sample, per solid angle
};

PathKind PathIntegrator::kind_after(Event next, PathKind none, PathKind passed, PathKind mirrored) {
  if (next == Event::kNone) return none;
  return next == Event::kPassed ? passed : mirrored;
}

PathIntegrator::Split PathIntegrator::of_reflection(const Followed& followed) {
  Split split;
  split.reflected = followed.radiance;
  split.reflected_kind = kind_after(followed.first, PathKind::kR, PathKind::kRT, PathKind::kRest);
  return split;
}

PathIntegrator::Split PathIntegrator::radiance(
    Vec3f origin, Vec3f direction, Sampler& sampler, Sampler& reflection_sampler
) const {
  Path path{origin, direction};
  const std::optional<Surface> first = scene_.intersect(origin, direction, RayMask::kAll);
  if (!first) return {scene_.scene().environment, {}};
  if (scene_.is_glass(*first)) return split_at_glass(path, *first, sampler, reflection_sampler);
  if (!scene_.is_mirror(*first)) return {follow(path, sampler, first).radiance, {}};
  meet_mirror(path, *first);
  return of_reflection(follow(path, sampler));
}

PathIntegrator::Split PathIntegrator::split_at_glass(
    Path path, const Surface& pane, Sampler& sampler, Sampler& reflection_sampler
) const {
  const Material& glass = scene_.material(pane);
  const float share = thin_slab_reflectance(-dot(path.direction, pane.normal), glass.ior);
  Path reflection = path;
  path.throughput = (1 - share) * glass.tint;
  path.pass(pane);
  reflection.throughput = {share, share, share};
  reflection.reflect(pane);
  const Followed behind = follow(path, sampler);
  Split split = of_reflection(follow(reflection, reflection_sampler));
  split.transmitted = behind.radiance;
  split.transmitted_kind = kind_after(behind.first, PathKind::kT, PathKind::kTT, PathKind::kTR);
  return split;
}

PathIntegrator::Followed PathIntegrator::follow(
    Path path, Sampler& sampler, std::optional<Surface> next
) const {
  Followed followed;
  Vec3f& sum = followed.radiance;
  bool smooth = true;  // nothing met, or nothing but panes and mirrors
  while (path.alive(settings_.max_bounces)) {
    if (!next) next = scene_.intersect(path.origin, path.direction, RayMask::kAll);
    if (!next) {
      sum += hadamard(path.throughput, scene_.scene().environment);
      return followed;
    }
    const bool glass = scene_.is_glass(*next);
    if (glass || scene_.is_mirror(*next)) {
      const Event event = glass ? cross_glass(path, *next, sampler) : meet_mirror(path, *next);
      if (smooth && followed.first == Event::kNone) followed.first = event;
    } else {
      sum += emitted(path, *next);
      sum += scatter(path, *next, sampler);
      smooth = false;
    }
    next.reset();
  }
  return followed;
}

// Reflects with probability R, otherwise passes straight through.
PathIntegrator::Event PathIntegrator::cross_glass(
    Path& path, const Surface& surface, Sampler& sampler
) const {
  const Material& glass = scene_.material(surface);
  const float share = thin_slab_reflectance(-dot(path.direction, surface.normal), glass.ior);
  if (sampler.next_1d() < share) {
    path.reflect(surface);
    return Event::kMirrored;
  }
  path.throughput = hadamard(path.throughput, glass.tint);
  path.pass(surface);
  return Event::kPassed;
}

PathIntegrator::Event PathIntegrator::meet_mirror(Path& path, const Surface& surface) const {
  path.throughput = hadamard(path.throughput, scene_.albedo(surface));
  path.reflect(surface);
  return Event::kMirrored;
}

Vec3f PathIntegrator::emitted(const Path& path, const Surface& surface) const {
  const Vec3f radiance = scene_.material(surface).emission;
  if (max_component(radiance) <= 0) return {};
  float weight = 1;
  if (path.pdf > 0 && settings_.next_event_estimation) {
    const float distance = path.distance + surface.t;
    const float cosine = -dot(path.direction, surface.normal);
    const float pdf_light = lights_.pdf_area(radiance) * distance * distance / cosine;
    weight = power_heuristic(path.pdf, pdf_light);
  }
  return weight * hadamard(path.throughput, radiance);
}

// Direct light scattered back along the path; then the path goes on by a sample of the BSDF.
Vec3f PathIntegrator::scatter(Path& path, const Surface& surface, Sampler& sampler) const {
  const Arrival arrival(surface, path.direction);
  const Vec3f throughput = path.throughput;
  path.throughput = {};
  if (path.bounces++ >= settings_.max_bounces) return {};

  const Vec2f light_u = sampler.next_2d(), bsdf_u = sampler.next_2d();
  // The shadow ray first: meanwhile the texels arrive, for which the albedo would have to wait.
  const Illumination light = illumination(surface, arrival, light_u);
  const Bsdf bsdf(scene_.model(surface), scene_.albedo(surface));
  const Vec3f direct = hadamard(throughput, direct_light(light, arrival, bsdf));
  const BsdfSample sample = bsdf.sample(arrival.wo, bsdf_u);
  const Vec3f wi = arrival.frame.to_world(sample.wi);
  // A shading normal may send light through the surface: absorbed.
  if (sample.pdf <= 0 || dot(wi, surface.normal) <= 0) return direct;
  path.continue_from(surface, wi, hadamard(throughput, sample.weight), sample.pdf);
  russian_roulette(path, sampler);
  return direct;
}

PathIntegrator::Illumination PathIntegrator::illumination(
    const Surface& surface, const Arrival& arrival, Vec2f u
) const {
  if (lights_.empty() || !settings_.next_event_estimation) return {};
  const LightSample light = lights_.sample(u);
  const Vec3f to_light = light.position - surface.position;
  const float distance = length(to_light);
  const Vec3f wi = (1 / distance) * to_light, local = arrival.frame.to_local(wi);
  const float cosine = std::abs(dot(light.normal, wi));
  if (!(distance > 0) || cosine <= 0 || dot(wi, surface.normal) <= 0) return {};
  if (!Bsdf::above_surface(arrival.wo, local)) return {};
  const Vec3f passed = scene_.transmittance(
      RayScene::leave(surface.position, surface.normal, wi),
      RayScene::leave(light.position, light.normal, -wi)
  );
  return {local, passed, light.radiance, light.pdf_area * distance * distance / cosine};
}

Vec3f PathIntegrator::direct_light(
    const Illumination& light, const Arrival& arrival, const Bsdf& bsdf
) {
  if (max_component(light.passed) <= 0) return {};
  const BsdfValue value = bsdf.evaluate(arrival.wo, light.wi);
  if (value.pdf <= 0) return {};
  const float weight = power_heuristic(light.pdf, value.pdf) / light.pdf;
  return weight * hadamard(hadamard(value.f_cos, light.passed), light.radiance);
}

// Survives with the square root of its throughput as probability: in a room the throughput itself
// kills paths that still matter (measured: a third more variance times time).
void PathIntegrator::russian_roulette(Path& path, Sampler& sampler) {
  if (path.bounces < kRouletteStart) return;
  const float survival = std::min(std::sqrt(max_component(path.throughput)), kMaxSurvival);
  if (sampler.next_1d() < survival)
    path.throughput = (1 / survival) * path.throughput;
  else
    path.throughput = {};
}

}  // namespace glint::path_tracing
