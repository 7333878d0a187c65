// SPDX-License-Identifier: MIT
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>

#include "glint/core/device.h"
#include "glint/core/files.h"
#include "glint/core/machine.h"
#include "glint/method.h"
#include "glint/scene/ply.h"
#include "glint/train/adam.h"
#include "glint/train/normal_consistency.h"
#include "glint/train/photometric.h"
#include "metrics/ssim.h"
#include "reports/run/perf/perf_scene.h"

namespace glint {

namespace {

// So many floats, each moved so many times.
double bytes_of(std::size_t floats, int moves) {
  return static_cast<double>(floats * sizeof(float)) * moves;
}

PerfCase photometric_case(const PerfOptions& options) {
  struct State {
    Image x, y, gradient;
    PhotometricLoss loss;
  };
  const auto s = std::make_shared<State>();
  s->y = perf_scene(options).train.front().rgb;
  s->x = Image(options.width, options.height, 3, 0.4f);
  s->gradient = Image(options.width, options.height, 3);
  return {
      "L1 + SSIM with gradient",
      "pixels",
      [s] { return static_cast<double>(s->x.num_pixels()); },
      [s] { s->loss.evaluate(s->x, s->y, {}, s->gradient); },
      {},
      [s] { return bytes_of(s->x.values().size(), 4); }};
}

PerfCase normal_case(const PerfOptions& options) {
  struct State {
    Camera camera;
    Image normal, depth, alpha, dL_dn, dL_dz;
    NormalConsistencyLoss loss;
  };
  const auto s = std::make_shared<State>();
  s->camera = perf_scene(options).train.front().camera;
  s->normal = s->dL_dn = Image(options.width, options.height, 3, -0.5f);
  s->depth = s->alpha = s->dL_dz = Image(options.width, options.height, 1, 1.0f);
  return {
      "normal consistency with gradient",
      "pixels",
      [s] { return static_cast<double>(s->depth.num_pixels()); },
      [s] {
        s->loss.evaluate(s->camera, s->normal, s->depth, s->alpha, 0.05f, s->dL_dn, s->dL_dz);
      },
      {}};
}

PerfCase adam_case(const PerfOptions& options) {
  struct State {
    SurfelCloud cloud, gradient;
    SurfelAdam adam;
  };
  const auto s = std::make_shared<State>();
  s->cloud = s->gradient = perf_cloud(options);
  return {
      "Adam, 58 values a surfel",
      "surfels",
      [s] { return static_cast<double>(s->cloud.size()); },
      [s] { s->adam.step(s->cloud, s->gradient, {}, 1); },
      {},
      [s] { return bytes_of(58 * s->cloud.size(), 8); }};
}

// The arrays of perf_cloud() in every set that the method saves; extra channels are repeated.
void write_perf_sets(const Method& method, const fs::path& folder, const PerfOptions& options) {
  method.save(folder.string());
  for (const fs::path& file : list_files(folder, {".ply"})) {
    SurfelCloud cloud = perf_cloud(options);
    const SurfelCloud saved = read_surfel_ply(file);
    cloud.extra_names = saved.extra_names;
    cloud.extra_logits.resize(cloud.size() * saved.num_extra());
    for (std::size_t i = 0; i < cloud.extra_logits.size(); ++i)
      cloud.extra_logits[i] = saved.extra_logits[i % saved.extra_logits.size()];
    write_surfel_ply(file, cloud);
  }
}

// Of 30000: every set, loss and network of every method has started, none is frozen yet.
constexpr int kLateIteration = 19000;

// Whole steps of a method late in training (all sets and losses, SH degree 3), without
// densification, every set with the same surfels as the ops.
PerfCase step_case(
    const std::string& name, const std::string& id, Json config, const PerfOptions& options
) {
  struct State {
    Scene scene;
    std::unique_ptr<Method> method;
    int iteration = kLateIteration;
  };
  const auto s = std::make_shared<State>();
  s->scene = perf_scene(options);
  config["densify_until"] = 0;
  s->method = create_method(id, config);
  s->method->initialize(s->scene, {30000, 0});
  const TemporaryFolder folder("glint_perf");
  write_perf_sets(*s->method, folder.path(), options);
  s->method->load(folder.path().string());
  return {name, "steps", [] { return 1.0; }, [s] { s->method->step(s->iteration++); }, {}};
}

PerfCase ssim_metric_case() {
  const auto image = std::make_shared<Image>(960, 540, 3, 0.4f);
  return {
      "metric ssim-3dgs, 960x540",
      "pixels",
      [image] { return static_cast<double>(image->num_pixels()); },
      [image] { ssim_3dgs(*image, *image); },
      {}};
}

std::vector<PerfCase> training_cases(const PerfOptions& options) {
  std::vector<PerfCase> cases = {
      photometric_case(options), normal_case(options), adam_case(options)};
  if (!on_gpu()) cases.push_back(ssim_metric_case());
  const auto add = [&](const std::string& name, const std::string& id, const Json& config) {
    if (options.wants(name)) cases.push_back(step_case(name, id, config, options));
  };
  for (const auto& [id, spec] : Registry<MethodSpec>::all())
    if (spec.overrides.empty()) add(id + " training step", id, Json::object());
  add("glint step, transmission traced", "glint", Json{{"transmission", "trace"}});
  for (const int layers : {1, 2, 3})
    add(fmt::format("glint/plus step, {} layers", layers), "glint/plus", Json{{"layers", layers}});
  add("envgs step, rays shared", "envgs", Json{{"mirror_share_below", 0.2}});
  return cases;
}

}  // namespace

namespace {

// The least of the runs, after one to warm up.
double least_seconds(const PerfCase& timed, int runs) {
  using Clock = std::chrono::steady_clock;
  timed.run();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const auto start = Clock::now();
    timed.run();
    synchronize();
    least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return least;
}

}  // namespace

StepCost cost_of_step(const std::string& method, const PerfOptions& options) {
  ::malloc_trim(0);  // what was freed before is not this method's
  const double before = static_cast<double>(resident_memory_bytes()) / 1e6;
  reset_device_peak();
  const double device_before = device_peak_mb();
  const PerfCase timed = step_case(method, method, Json::object(), options);
  ::malloc_trim(0);
  reset_peak_memory();
  const double seconds = least_seconds(timed, options.runs);
  if (on_gpu()) return {seconds, device_peak_mb() - device_before};
  return {seconds, peak_memory_mb() - before};
}

GLINT_REGISTER(PerfCases, {"training", training_cases})

}  // namespace glint
