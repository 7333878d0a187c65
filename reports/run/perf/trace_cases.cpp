// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>

#include "glint/core/device.h"
#include "glint/core/rng.h"
#include "glint/render/activations.h"
#include "glint/render/trace.h"
#include "glint/render/trace_bvh.h"
#include "reports/run/perf/perf_scene.h"

namespace glint {

namespace {

struct TraceScene {
  SurfelCloud cloud;
  Rays rays;
};

// 32,400 rays (240x135) from random points in the middle of a room of 100,000 surfels, in random
// directions: as incoherent as mirrored rays get.
TraceScene incoherent(PerfOptions options, float overlap) {
  options.surfels = 100000;
  options.overlap = overlap;
  TraceScene scene{
      perf_cloud(options),
      {Image(options.width, options.height, 3), Image(options.width, options.height, 3)}};
  Rng rng(3);
  for (float& value : scene.rays.origins.values()) value = rng.uniform(-0.8f, 0.8f);
  for (float& value : scene.rays.directions.values()) value = rng.normal();
  return scene;
}

constexpr float kFogRoom[3] = {6, 6, 3};  // metres

// Surfels of any orientation in every cell of the room.
struct Fog {
  std::size_t cells, per_cell;  // cells: along each axis
  float scale, opacity;         // scale: metres

  std::size_t count() const { return per_cell * cells * cells * cells; }
};

SurfelCloud fog_cloud(const Fog& fog) {
  Rng rng(5);
  SurfelCloud cloud;
  cloud.resize(fog.count());
  for (std::size_t i = 0; i < fog.count(); ++i) {
    std::size_t cell = i / fog.per_cell;
    for (std::size_t k = 0; k < 3; ++k, cell /= fog.cells) {
      const float within = static_cast<float>(cell % fog.cells) + rng.uniform();
      const float place = within / static_cast<float>(fog.cells);
      cloud.means[3 * i + k] = kFogRoom[k] * (place - 0.5f);
      cloud.sh_dc[3 * i + k] = rng.uniform(-1, 1);
    }
    for (std::size_t k = 0; k < 4; ++k) cloud.rotations[4 * i + k] = rng.normal();
    for (std::size_t k = 0; k < 2; ++k) cloud.log_scales[2 * i + k] = std::log(fog.scale);
    for (std::size_t k = 0; k < 45; ++k) cloud.sh_rest[45 * i + k] = 0.05f * rng.normal();
    cloud.opacity_logits[i] = logit(fog.opacity);
  }
  return cloud;
}

// The ray of one pixel of a camera in the fog room, mirrored where it meets a wall.
void mirror_ray(Vec3f direction, float* origin, float* mirrored) {
  const Vec3f eye{-0.5f, -1.8f, 0.2f};
  float t = std::numeric_limits<float>::max();
  int axis = 0;
  for (int k = 0; k < 3; ++k) {
    const float wall = (std::copysign(0.5f * kFogRoom[k], direction[k]) - eye[k]) / direction[k];
    if (wall < t) t = wall, axis = k;
  }
  for (int k = 0; k < 3; ++k) {
    origin[k] = eye[k] + t * direction[k];
    mirrored[k] = k == axis ? -direction[k] : direction[k];
  }
}

// 14,400 rays (160x90), neighbours alike.
TraceScene mirrored_fog(const Fog& fog) {
  constexpr int kWidth = 160, kHeight = 90;
  TraceScene scene{fog_cloud(fog), {Image(kWidth, kHeight, 3), Image(kWidth, kHeight, 3)}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const auto i = static_cast<std::size_t>(3 * (y * kWidth + x));
      const float right = static_cast<float>(x) + 0.5f - 0.5f * kWidth;
      const float down = static_cast<float>(y) + 0.5f - 0.5f * kHeight;
      mirror_ray(
          normalize(Vec3f{right / 100, 1, -down / 100}),
          scene.rays.origins.data() + i,
          scene.rays.directions.data() + i
      );
    }
  return scene;
}

struct TraceState {
  TraceScene scene;
  ActivatedSurfels activated;
  Tracer tracer;
  TraceOutputGradient dL_doutput;

  explicit TraceState(TraceScene traced) : scene(std::move(traced)) {
    activate_geometry(scene.cloud, activated);
    const Image& rays = scene.rays.origins;
    dL_doutput.color = Image(rays.width(), rays.height(), 3, 1e-4f);
    forward();  // for hits_per_ray() and backward()
  }
  TraceInput input() const { return trace_input(scene.cloud, activated, 3); }
  void forward() { tracer.forward({input(), scene.rays, {}}); }
  void backward() { tracer.backward(dL_doutput); }
  double hits() const { return static_cast<double>(tracer.num_hits()); }
  double hits_per_ray() const {
    return hits() / static_cast<double>(scene.rays.origins.num_pixels());
  }
};

std::string case_name(const std::string& scene, double hits_per_ray) {
  return fmt::format("trace {} {:.1f} hits/ray", scene, hits_per_ray);
}

// The names have hits that only a run tells: any number will do.
bool may_be_wanted(const PerfOptions& options, const std::string& scene) {
  const std::string some = case_name(scene, 0);
  return options.wants(some) || options.wants(some + " backward") ||
         options.only.find("hits/ray") != std::string::npos;
}

void add_cases(
    const std::string& name, const std::shared_ptr<TraceState>& s, std::vector<PerfCase>& cases
) {
  const std::string forward = case_name(name, s->hits_per_ray());
  const auto hits = [s] { return s->hits(); };
  cases.push_back({forward, "hits", hits, [s] { s->forward(); }, {}});
  cases.push_back({forward + " backward", "hits", hits, [s] { s->backward(); }, {}});
}

std::vector<PerfCase> trace_cases(const PerfOptions& options) {
  std::vector<PerfCase> cases;
  const auto add = [&](const char* name, auto&& scene) {
    if (may_be_wanted(options, name)) add_cases(name, std::make_shared<TraceState>(scene()), cases);
  };
  add("100k", [&] { return incoherent(options, options.overlap); });
  // As many hits as in the published measurement of bare traversals.
  add("100k", [&] { return incoherent(options, 1.75f); });
  // What mirrored rays meet early in GLINT's training: faint surfels about as large as their
  // distances; and late: fewer and so large that their boxes overlap everywhere.
  add("fog", [] { return mirrored_fog({15, 5, 0.11f, 0.1f}); });
  add("large surfels", [] { return mirrored_fog({12, 5, 0.2f, 0.3f}); });
  return cases;
}

}  // namespace

GLINT_REGISTER(PerfCases, {"trace", trace_cases})

}  // namespace glint
