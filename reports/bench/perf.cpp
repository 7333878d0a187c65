// SPDX-License-Identifier: MIT
#include "reports/bench/perf.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "glint/core/parallel.h"
#include "glint/core/rng.h"
#include "glint/method.h"
#include "glint/render/raster_tiles.h"
#include "glint/render/rasterize.h"

namespace glint {

namespace {

// Median seconds of a call; the first one warms up and is not counted.
template <class F>
double median_seconds(double min_seconds, F&& body) {
  body();
  std::vector<double> times;
  for (double total = 0; total < min_seconds || times.size() < 3; total += times.back()) {
    const auto start = std::chrono::steady_clock::now();
    body();
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()
    );
  }
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

// Points in a box of 4 x 2.25 x 3 m before the camera, as dense as a small room's.
Vec3f random_point(Rng& rng) {
  return {rng.uniform(-2, 2), rng.uniform(-1.125f, 1.125f), rng.uniform(2, 5)};
}

Camera perf_camera(const PerfOptions& options) {
  Camera camera;
  camera.width = options.width;
  camera.height = options.height;
  camera.fx = camera.fy = options.width;  // 53 degrees across
  camera.cx = options.width / 2.0;
  camera.cy = options.height / 2.0;
  return camera;
}

struct PerfSurfels {
  std::vector<float> means, scales, rotations, opacities, features;
  RasterInput input;

  explicit PerfSurfels(const PerfOptions& options) {
    Rng rng(1);
    for (int i = 0; i < options.surfels; ++i) {
      const Vec3f mean = random_point(rng);
      means.insert(means.end(), {mean.x, mean.y, mean.z});
      for (int k = 0; k < 2; ++k) scales.push_back(0.015f * std::exp(0.5f * rng.normal()));
      for (int k = 0; k < 4; ++k) rotations.push_back(rng.normal());
      opacities.push_back(rng.uniform(0.1f, 0.95f));
      for (int k = 0; k < options.channels; ++k) features.push_back(rng.uniform());
    }
    input = {opacities.size(), options.channels, means, scales, rotations, opacities, features, {}};
  }
};

// Times of one instantiation.
struct RasterTimes {
  double forward = 0, both = 0;  // seconds
  double pairs = 0;              // surfel-pixel pairs of a forward call
};

RasterTimes time_rasterizer(
    const PerfOptions& options, const PerfSurfels& surfels, const Camera& camera, bool scalar
) {
  Rasterizer rasterizer;
  RasterOutput output;
  RasterGradient gradient;
  RasterOutputGradient dL_doutput;
  dL_doutput.features = Image(options.width, options.height, options.channels, 1.0f);
  const auto forward = [&] { rasterizer.forward(surfels.input, camera, {}, output, scalar); };
  RasterTimes times;
  times.forward = median_seconds(options.min_seconds, forward);
  times.both = median_seconds(options.min_seconds, [&] {
    forward();
    rasterizer.backward(surfels.input, camera, {}, output, dL_doutput, gradient, scalar);
  });
  times.pairs = static_cast<double>(rasterizer.num_pairs()) * kTileSize * kTileSize;
  return times;
}

void add_rasterizer(
    const PerfOptions& options, const PerfSurfels& surfels, int threads, std::vector<PerfRow>& rows
) {
  set_num_threads(threads);
  const Camera camera = perf_camera(options);
  const RasterTimes simd = time_rasterizer(options, surfels, camera, false);
  const RasterTimes scalar = time_rasterizer(options, surfels, camera, true);
  const auto add = [&](const char* op, double seconds, double scalar_seconds) {
    rows.push_back({op, threads, seconds * 1e3, simd.pairs / seconds, scalar_seconds / seconds});
    rows.push_back(
        {std::string(op) + ", scalar",
         threads,
         scalar_seconds * 1e3,
         simd.pairs / scalar_seconds,
         1}
    );
  };
  add("rasterize forward", simd.forward, scalar.forward);
  add("rasterize forward + backward", simd.both, scalar.both);
}

// A scene of one view to step on: coloured points, a grey image.
Scene perf_scene(const PerfOptions& options) {
  Scene scene;
  scene.name = "perf";
  Rng rng(2);
  for (int i = 0; i < options.surfels; ++i) {
    scene.points.positions.push_back(random_point(rng));
    scene.points.colors.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
  }
  View view;
  view.name = "perf";
  view.camera = perf_camera(options);
  view.rgb = Image(options.width, options.height, 3, 0.5f);
  scene.train = {view};
  return scene;
}

// Whole training steps of every method, before anything is densified.
void add_methods(
    const PerfOptions& options, const Scene& scene, int threads, std::vector<PerfRow>& rows
) {
  set_num_threads(threads);
  for (const auto& [id, spec] : method_registry()) {
    const auto method = spec.create(Json::object());
    method->initialize(scene, {});
    int iteration = 0;
    const double seconds = median_seconds(options.min_seconds, [&] { method->step(iteration++); });
    rows.push_back({id + " step", threads, seconds * 1e3, 0, 0});
  }
}

}  // namespace

std::vector<PerfRow> run_perf(const PerfOptions& options) {
  const int threads_before = num_threads();
  const PerfSurfels surfels(options);
  const Scene scene = perf_scene(options);
  std::vector<PerfRow> rows;
  for (const int threads : std::set<int>{1, threads_before}) {
    add_rasterizer(options, surfels, threads, rows);
    add_methods(options, scene, threads, rows);
  }
  set_num_threads(threads_before);
  return rows;
}

}  // namespace glint
