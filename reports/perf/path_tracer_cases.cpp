// SPDX-License-Identifier: MIT
// The path tracer on a view of a room of half the size, and Embree alone on the very same rays: the
// ratio of the two rates is the share of the time in which rays are traced.
#include <algorithm>
#include <memory>
#include <string>

#include "datasets/glassroom/glassroom_scene.h"
#include "datasets/glassroom/path_tracer.h"
#include "glint/core/parallel.h"
#include "reports/perf/perf.h"

namespace glint {

namespace {

constexpr const char* kTracerName = "path tracer";
constexpr const char* kEmbreeName = "path tracer's rays, Embree alone";
constexpr PathTracerSettings kSettings{.spp = 4, .seed = 1};
constexpr std::size_t kView = 1, kBlock = 4096;

struct PathState {
  std::unique_ptr<GlassRoomScene> scene;
  std::vector<TracedRay> rays;
  std::vector<std::size_t> num_met;  // of each block, so that nothing can be left out

  const Camera& camera() const { return scene->cameras[kView]; }
  double work() const { return static_cast<double>(rays.size()); }
};

std::shared_ptr<PathState> make_state(const PerfOptions& options) {
  GlassRoomOptions room;
  room.width = std::max(8, options.width / 2);
  room.height = std::max(8, options.height / 2);
  room.views = 8;
  auto state = std::make_shared<PathState>();
  state->scene = build_glassroom_scene(room);
  state->rays = state->scene->tracer->rays_of(state->camera(), kSettings);
  state->num_met.resize(state->rays.size() / kBlock + 1);
  return state;
}

void trace_alone(PathState& state) {
  const std::span<const TracedRay> rays = state.rays;
  parallel_for_blocks(rays.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    state.num_met[begin / kBlock] =
        state.scene->tracer->count_met(rays.subspan(begin, end - begin));
  });
}

std::vector<PerfCase> path_tracer_cases(const PerfOptions& options) {
  if (!options.wants(kTracerName) && !options.wants(kEmbreeName)) return {};
  const std::shared_ptr<PathState> s = make_state(options);
  const auto work = [s] { return s->work(); };
  return {
      {kTracerName, "rays", work, [s] { s->scene->tracer->render(s->camera(), kSettings); }, {}},
      {kEmbreeName, "rays", work, [s] { trace_alone(*s); }, {}}};
}

}  // namespace

GLINT_REGISTER(PerfCases, {"path_tracer", path_tracer_cases})

}  // namespace glint
