// SPDX-License-Identifier: MIT
// Radiance along a ray: a path traced with next-event estimation and BSDF sampling, combined by the
// power heuristic, [Veach97] Sec. 9.2. Shadow rays cross thin glass straight with its
// transmittance; sampled paths cross it straight as well, so both strategies reach the same light
// points: a light seen through panes is weighted by the density at the last rough vertex. After a
// mirror reflection at glass only the sampled path can arrive, and counts fully.
#pragma once

#include "datasets/glassroom/light_sampling.h"
#include "datasets/glassroom/ray_scene.h"
#include "datasets/glassroom/sampler.h"

namespace glint::path_tracing {

struct IntegratorSettings {
  int max_bounces = 200;              // passing straight through glass is no bounce
  bool next_event_estimation = true;  // off: BSDF sampling alone (slow; for checks)
};

class PathIntegrator {
 public:
  PathIntegrator(const RayScene& scene, const LightSampler& lights, IntegratorSettings settings)
      : scene_(scene), lights_(lights), settings_(settings) {}

  // Radiance that arrives at the ray's origin when its first hit is opaque or nothing.
  // At glass, the two branches separately: what the pane lets pass and what it mirrors.
  struct Split {
    Vec3f transmitted{}, reflected{};
    bool glass = false;  // false: everything is in `transmitted`
  };
  Split radiance(Vec3f origin, Vec3f direction, Sampler& sampler, Sampler& reflection_sampler)
      const;

 private:
  struct Path;
  struct Arrival;
  struct Illumination;
  // `next`: the path's next surface, where known already.
  Vec3f follow(Path path, Sampler& sampler, std::optional<Surface> next = {}) const;
  void cross_glass(Path& path, const Surface& surface, Sampler& sampler) const;
  Vec3f emitted(const Path& path, const Surface& surface) const;
  Vec3f scatter(Path& path, const Surface& surface, Sampler& sampler) const;
  Illumination illumination(const Surface& surface, const Arrival& arrival, Vec2f u) const;
  static Vec3f direct_light(const Illumination& light, const Arrival& arrival, const Bsdf& bsdf);
  static void russian_roulette(Path& path, Sampler& sampler);

  const RayScene& scene_;
  const LightSampler& lights_;
  IntegratorSettings settings_;
};

}  // namespace glint::path_tracing
