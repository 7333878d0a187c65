// SPDX-License-Identifier: MIT
// Radiance along a ray: a path traced with next-event estimation and BSDF sampling, combined by the
// power heuristic, [Veach97] Sec. 9.2. Shadow rays cross thin glass straight with its
// transmittance; sampled paths cross it straight as well, so both strategies reach the same light
// points: a light seen through panes is weighted by the density at the last rough vertex. After a
// reflection at glass or at a mirror only the sampled path can arrive, and counts fully.
#pragma once

#include "datasets/glassroom/light_sampling.h"
#include "datasets/glassroom/ray_scene.h"
#include "datasets/glassroom/sampler.h"

namespace glint::path_tracing {

struct IntegratorSettings {
  int max_bounces = 200;              // passing straight through glass is no bounce
  bool next_event_estimation = true;  // off: BSDF sampling alone (slow; for checks)
};

// What a path from the camera did at the first two panes or mirrors on its way, before anything
// rough: passed (T) or was mirrored (R). T: also none of them.
enum class PathKind { kT, kTT, kR, kTR, kRT, kRest };
inline constexpr int kNumPathKinds = 6;

class PathIntegrator {
 public:
  PathIntegrator(const RayScene& scene, const LightSampler& lights, IntegratorSettings settings)
      : scene_(scene), lights_(lights), settings_(settings) {}

  // Radiance that arrives at the ray's origin when its first hit is rough or nothing: transmitted.
  // At glass, the two branches separately: what the pane lets pass and what it mirrors. What a
  // mirror shows is reflected. Each branch is one path, so all of it is of one kind.
  struct Split {
    Vec3f transmitted{}, reflected{};
    PathKind transmitted_kind = PathKind::kT, reflected_kind = PathKind::kR;
  };
  Split radiance(Vec3f origin, Vec3f direction, Sampler& sampler, Sampler& reflection_sampler)
      const;

 private:
  struct Path;
  struct Arrival;
  struct Illumination;
  enum class Event { kNone, kPassed, kMirrored };
  struct Followed {
    Vec3f radiance{};
    Event first = Event::kNone;  // at a pane or mirror, before anything rough
  };
  // `next`: the path's next surface, where known already.
  Followed follow(Path path, Sampler& sampler, std::optional<Surface> next = {}) const;
  // Of a path with one event behind it: what it is with the next one.
  static PathKind kind_after(Event next, PathKind none, PathKind passed, PathKind mirrored);
  static Split of_reflection(const Followed& followed);
  Split split_at_glass(Path path, const Surface& pane, Sampler& sampler, Sampler& reflection) const;
  Event cross_glass(Path& path, const Surface& surface, Sampler& sampler) const;
  Event meet_mirror(Path& path, const Surface& surface) const;
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
