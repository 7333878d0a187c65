// SPDX-License-Identifier: MIT
// What a training from random points begins with: many faint, large surfels one behind the other,
// nearly all of which count in a pixel. Modelled on the capture `fox` at 135x240 with 20,000 points
// in [-3, 3]^3 and steps 20 to 80, as other programs have been timed on it: its size, focal length,
// number of views and mean distance; pictures and the cameras' arc are made up. What was compared
// with fox is the time of a step only (39 to 50 ms here, 45 to 53 there, on two threads).
#include <cmath>
#include <memory>

#include "glint/core/rng.h"
#include "glint/method.h"
#include "reports/run/perf/perf_scene.h"

namespace glint {

namespace {

constexpr ImageSize kSize{135, 240};
constexpr double kFocal = 171.9;  // pixels: 687.8 at 540x960
constexpr int kViews = 50;
constexpr double kDistance = 5.1;  // of the cameras from the middle, the mean of fox
constexpr float kHalfCube = 3;
constexpr std::size_t kPoints = 20000;
constexpr int kFirstStep = 20;

// Blobs of colour, so that there is something to learn; the same seen from everywhere.
Image blobs() {
  Image image(kSize.width, kSize.height, 3);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = 0.5f + 0.4f * std::sin(0.05f * static_cast<float>(x + 40 * c)) *
                                       std::cos(0.04f * static_cast<float>(y));
  return image;
}

// On an arc of 120 degrees, at changing heights, turned to the middle.
View haze_view(int index) {
  const double at = static_cast<double>(index) / (kViews - 1), angle = (at - 0.5) * 2.1;
  View view;
  view.name = fmt::format("{:04}", index);
  const Vec3d eye{
      kDistance * std::sin(angle), 1.5 * std::sin(9 * at), -kDistance * std::cos(angle)};
  const double field = 2 * std::atan(0.5 * kSize.width / kFocal) * 180 / 3.14159265358979;
  view.camera = look_at(eye, {0, 0, 0}, {0, -1, 0}, kSize, field);
  view.rgb = blobs();
  return view;
}

Scene haze_scene() {
  Scene scene;
  scene.name = "haze";
  scene.spatial_scale = 5;
  scene.bounds_min = {-kHalfCube, -kHalfCube, -kHalfCube};
  scene.bounds_max = {kHalfCube, kHalfCube, kHalfCube};
  for (int i = 0; i < kViews; ++i) scene.train.push_back(haze_view(i));
  Rng rng(3, hash_name("haze"));
  for (std::size_t i = 0; i < kPoints; ++i) {
    Vec3f p, color;
    for (int k = 0; k < 3; ++k) p[k] = kHalfCube * rng.uniform(-1, 1), color[k] = rng.uniform();
    scene.points.positions.push_back(p);
    scene.points.colors.push_back(color);
  }
  return scene;
}

// Steps from the twentieth on, of 30000.
PerfCase haze_case(const std::string& name, const std::string& method) {
  struct State {
    Scene scene = haze_scene();
    std::unique_ptr<Method> method;
    int iteration = 0;
  };
  const auto s = std::make_shared<State>();
  s->method = create_method(method, Json::object());
  s->method->initialize(s->scene, {30000, 0});
  const auto step = [s] { s->method->step(s->iteration++); };
  return {
      name,
      "steps",
      [] { return 1.0; },
      [s, step] {
        while (s->iteration < kFirstStep) step();
        step();
      },
      {}};
}

std::vector<PerfCase> haze_cases(const PerfOptions& options) {
  std::vector<PerfCase> cases;
  const std::string name = "2dgs training step, haze";
  if (options.wants(name)) cases.push_back(haze_case(name, "2dgs"));
  return cases;
}

GLINT_REGISTER(PerfCases, {"haze", haze_cases})

}  // namespace

}  // namespace glint
