// SPDX-License-Identifier: MIT
#include "datasets/glassroom/sfm_points.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "datasets/glassroom/glassroom_scene.h"
#include "glint/core/progress.h"

using namespace glint;

namespace {

// Distance to the plane of a pane, inside its rectangle; large elsewhere.
float distance_to_pane(const Pane& pane, Vec3f local) {
  const Vec3f d = local - pane.center;
  for (int i = 1; i < 3; ++i) {
    const int k = (pane.axis + i) % 3;
    if (std::abs(d[k]) > pane.half_size[k] - 0.03f) return 1e3f;
  }
  return std::abs(d[pane.axis]);
}

}  // namespace

TEST_CASE("Simulated points lie on opaque surfaces near where several views see them") {
  set_quiet(true);
  const auto scene = build_glassroom_scene({.width = 96, .height = 54, .views = 24, .spp = 1});
  SfmModel model;
  model.num_points = 1500;
  const auto points = sfm_points(*scene->tracer, scene->cameras, model, 11);
  REQUIRE(points.size() > 1200);
  double error2 = 0;
  std::size_t on_glass = 0;
  for (const SfmPoint& point : points) {
    error2 += static_cast<double>(length2(point.position - point.true_position));
    const Pose& box = scene->settled.container;
    const Vec3f local = transpose_times(box.rotation, point.true_position - box.translation);
    for (const Pane& pane : container_panes(scene->container))
      on_glass += pane.center.z > 0.1f && distance_to_pane(pane, local) < 1e-4f;
  }
  CHECK(on_glass == 0);
  const double rms = std::sqrt(error2 / static_cast<double>(points.size()));
  CHECK(rms > 1e-4);
  CHECK(rms < 0.02);  // half a pixel of 960 at 3 m is 3 mm
}

TEST_CASE("The same seed gives the same points, and few lie behind glass") {
  const auto scene = build_glassroom_scene({.width = 96, .height = 54, .views = 24, .spp = 1});
  SfmModel model;
  model.num_points = 400;
  const auto a = sfm_points(*scene->tracer, scene->cameras, model, 1);
  const auto b = sfm_points(*scene->tracer, scene->cameras, model, 1);
  REQUIRE(a.size() == b.size());
  std::size_t through = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(length(a[i].position - b[i].position) == 0.0f);
    const Camera& camera = scene->cameras[static_cast<std::size_t>(a[i].view)];
    const Vec3d ray = camera.ray_in_world(a[i].x + 0.5, a[i].y + 0.5);
    through +=
        scene->tracer->first_hit(cast<float>(camera.center()), cast<float>(ray), false).glass;
  }
  const double share = static_cast<double>(through) / static_cast<double>(a.size());
  CHECK(share > 0);
  CHECK(share < scene->glass_share);
}
