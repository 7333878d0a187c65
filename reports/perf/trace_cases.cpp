// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/rng.h"
#include "glint/render/trace.h"
#include "reports/perf/perf_scene.h"

namespace glint {

namespace {

constexpr std::size_t kSurfels = 100000;  // as in the published measurement of bare traversals

// One ray a pixel, from random points in the middle of the room, in random directions: as
// incoherent as mirrored rays get.
struct TraceState {
  SurfelCloud cloud;
  ActivatedSurfels activated;
  Rays rays;
  Tracer tracer;
  TraceOutput output;
  TraceOutputGradient dL_doutput;
  TraceGradient gradient;
  TraceSettings settings;

  TraceState(PerfOptions options, bool triangles) {
    options.surfels = kSurfels;
    cloud = perf_cloud(options);
    activate_geometry(cloud, activated);
    rays = {Image(options.width, options.height, 3), Image(options.width, options.height, 3)};
    Rng rng(3);
    for (float& value : rays.origins.values()) value = rng.uniform(-0.8f, 0.8f);
    for (float& value : rays.directions.values()) value = rng.normal();
    dL_doutput.color = Image(options.width, options.height, 3, 1e-4f);
    settings.triangles = triangles;
  }
  void forward() { tracer.forward(trace_input(cloud, activated, 3), rays, settings, output); }
  void backward() {
    tracer.backward(trace_input(cloud, activated, 3), rays, settings, output, dL_doutput, gradient);
  }
};

}  // namespace

std::vector<PerfCase> trace_cases(const PerfOptions& options) {
  const auto discs = std::make_shared<TraceState>(options, false);
  const auto triangles = std::make_shared<TraceState>(options, true);
  const auto hits = [](const std::shared_ptr<TraceState>& s) {
    return [s] { return static_cast<double>(s->tracer.num_hits()); };
  };
  return {
      {"trace forward, 100k surfels", "hits", hits(discs), [s = discs] { s->forward(); }, {}},
      {"trace forward + backward",
       "hits",
       hits(discs),
       [s = discs] { s->forward(), s->backward(); },
       {}},
      {"trace forward, triangles", "hits", hits(triangles), [s = triangles] { s->forward(); }, {}}};
}

}  // namespace glint
