// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include "glint/render/shade.h"
#include "reports/run/perf/perf_scene.h"

namespace glint {

namespace {

struct RasterState {
  SurfelCloud cloud;
  View view;
  ActivatedSurfels activated;
  RasterInput input;
  Rasterizer rasterizer;
  RasterOutputGradient dL_doutput;
  const RasterGradient* gradient = nullptr;
  SurfelCloud dL_dcloud;

  explicit RasterState(const PerfOptions& options)
      : cloud(perf_cloud(options)), view(perf_scene(options).train.front()) {
    dL_dcloud.resize(cloud.size());
    shade();
    input = raster_input(cloud, activated);
    const float g = 1.0f / static_cast<float>(view.camera.size().num_pixels());
    dL_doutput.features = Image(options.width, options.height, 3, g);
    dL_doutput.alpha = Image(options.width, options.height, 1, g);
    dL_doutput.depth_sum = Image(options.width, options.height, 1, g);
    dL_doutput.normal = Image(options.width, options.height, 3, g);
  }
  void shade() { activate(cloud, cast<float>(view.camera.center()), 3, activated); }
  void shade_vjp() {
    activate_vjp(cloud, cast<float>(view.camera.center()), 3, activated, *gradient, dL_dcloud);
  }
  void forward(bool scalar) {
    RasterSettings settings;
    if (scalar) settings.lanes = 1;
    rasterizer.forward({input, view.camera, settings});
  }
  // From raw parameters, as a step does that has just changed them.
  void draw() {
    activated.revision = {};
    shade();
    input = raster_input(cloud, activated);
    forward(false);
  }
  void backward() { gradient = &rasterizer.backward(dL_doutput); }
  // Parameters and gradients of the surfels (12 geometry and feature values each), maps.
  double bytes(int surfel_moves, int map_moves) const {
    const double floats = 12.0 * static_cast<double>(cloud.size()) * surfel_moves +
                          9.0 * static_cast<double>(view.camera.size().num_pixels()) * map_moves;
    return floats * sizeof(float);
  }
  // Surfel-pixel pairs: pixels inside the surfels' exact screen boxes.
  double pairs() const { return static_cast<double>(rasterizer.num_pixel_pairs()); }
};

constexpr const char* kForward = "rasterize forward";
constexpr const char* kBackward = "rasterize forward + backward";
constexpr const char* kShade = "activate + SH degree 3";
constexpr const char* kShadeBackward = "activate + SH degree 3, backward";
// What other programs time as one: scripts/gsplat_check.sh.
constexpr const char* kDraw = "activate, SH, rasterize";
constexpr const char* kDrawBackward = "activate, SH, rasterize + backward";

std::vector<PerfCase> raster_cases(const PerfOptions& options) {
  const auto names = {kForward, kBackward, kShade, kShadeBackward, kDraw, kDrawBackward};
  const auto wanted = [&](const char* name) { return options.wants(name); };
  if (std::none_of(names.begin(), names.end(), wanted)) return {};
  const auto s = std::make_shared<RasterState>(options);
  s->forward(false);
  s->backward();
  const auto pairs = [s] { return s->pairs(); };
  const auto surfels = [s] { return static_cast<double>(s->cloud.size()); };
  return {
      {kForward,
       "pairs",
       pairs,
       [s] { s->forward(false); },
       [s] { s->forward(true); },
       [s] { return s->bytes(1, 1); }},
      {kBackward,
       "pairs",
       pairs,
       [s] { s->forward(false), s->backward(); },
       [s] { s->forward(true), s->backward(); },
       [s] { return s->bytes(3, 3); }},
      {kShade, "surfels", surfels, [s] { s->shade(); }, {}},
      {kShadeBackward, "surfels", surfels, [s] { s->shade_vjp(); }, {}},
      {kDraw, "pairs", pairs, [s] { s->draw(); }, {}},
      {kDrawBackward, "pairs", pairs, [s] { s->draw(), s->backward(), s->shade_vjp(); }, {}}};
}

}  // namespace

GLINT_REGISTER(PerfCases, {"raster", raster_cases})

}  // namespace glint
