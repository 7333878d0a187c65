// SPDX-License-Identifier: MIT
// Planes fitted to points, and mirrors told from other dark planes by photos.
#include "glint/train/find_mirrors.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/rng.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{60, 40};

// Points of a rectangle of 2 x 1 m, turned by 20 degrees in its plane, seen from the origin.
std::vector<SurfacePoint> rectangle_points(Vec3d center, Vec3d normal, double noise, Rng& rng) {
  const Vec3d a = normalize(cross(normal, Vec3d{0, 1, 0})), b = cross(normal, a);
  const Vec3d x = std::cos(0.35) * a + std::sin(0.35) * b, y = cross(normal, x);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 600; ++i) {
    const Vec3d on = center + static_cast<double>(rng.uniform(-1, 1)) * x +
                     static_cast<double>(rng.uniform(-0.5f, 0.5f)) * y;
    const double along = 1 + noise * static_cast<double>(rng.normal());  // along the way to it
    const Vec3d bent{
        0.03 * static_cast<double>(rng.normal()), 0, 0.03 * static_cast<double>(rng.normal())};
    points.push_back({along * on, normalize(normal + bent), {}});
  }
  return points;
}

}  // namespace

TEST_CASE("Planes come out of points that are off along the ways to them") {
  Rng rng(1);
  const Vec3d n1 = normalize(Vec3d{0.2, 0.1, -1}), n2 = normalize(Vec3d{-1, 0, -0.2});
  auto points = rectangle_points({0.2, -0.1, 4}, n1, 0.008, rng);
  const auto more = rectangle_points({2, 0.3, 3}, n2, 0.008, rng);
  points.insert(points.end(), more.begin(), more.end());
  for (int i = 0; i < 100; ++i)  // of no plane
    points.push_back(
        {{rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(1, 6)},
         normalize(Vec3d{rng.normal(), rng.normal(), rng.normal()}),
         {}}
    );
  const auto planes = fit_planes(points, {.tolerance = 0.1, .min_share = 0.1});
  REQUIRE(planes.size() == 2);
  for (const PlaneOfPoints& fitted : planes) {
    const MirrorPlane& plane = fitted.plane;
    const bool first = dot(plane.normal, n1) > 0.9;
    const Vec3d center = first ? Vec3d{0.2, -0.1, 4} : Vec3d{2, 0.3, 3};
    CHECK(dot(plane.normal, first ? n1 : n2) > std::cos(0.01));
    CHECK(std::abs(plane.signed_distance(center)) < 0.02);
    CHECK(length(plane.center - center) < 0.06);
    const double wide = std::max(plane.half_width, plane.half_height);
    const double narrow = std::min(plane.half_width, plane.half_height);
    CHECK(wide == Approx(1).margin(0.06));
    CHECK(narrow == Approx(0.5).margin(0.06));
    CHECK(fitted.points.size() > 500);
  }
}

namespace {

MirrorPlane wall_mirror() {
  MirrorPlane plane;
  plane.center = {0, 0, 3};
  plane.normal = {0, 0, -1};
  plane.half_width = 1.4, plane.half_height = 0.9;
  return plane;
}

// A wall of many colours behind the cameras; before them a dark plane 3 m away, of which the
// interface knows only that it is about there.
struct DarkWall {
  Scene scene;
  TrainableSet interface, transmission;
  MirrorsCall call;

  DarkWall() {
    Rng rng(3);
    SurfelCloud room;
    room.extra_names = {kTransparency, kSpecular};
    add_wall(room, -1.5, 5, rng);
    add_wall(room, 3.05, 2, rng);
    for (float& t : room.extra_logits) t = -6;
    interface = TrainableSet(room);
    SurfelCloud none;
    none.extra_names = {kTransparency, kSpecular};
    none.resize(1);
    none.means[2] = -50;
    transmission = TrainableSet(none);
    call.interface_degree = call.transmission_degree = 0;
    scene.spatial_scale = 2;
    for (int k = 0; k < 6; ++k) add_view(k);
  }
  static void add_wall(SurfelCloud& cloud, double depth, double half, Rng& rng) {
    for (double x = -half; x <= half; x += 0.25)
      for (double y = -half; y <= half; y += 0.25) {
        const std::size_t i = cloud.size();
        cloud.resize(i + 1);
        put3(cloud.means.data(), i, cast<float>(Vec3d{x, y, depth}));
        for (std::size_t k = 0; k < 3; ++k) cloud.sh_dc[3 * i + k] = rng.uniform(-1.5f, 1.5f);
        cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = std::log(0.13f);
        cloud.rotations[4 * i] = 1;
        cloud.opacity_logits[i] = 5;
      }
  }
  void add_view(int k) {
    View view;
    view.camera = look_at({0.3 * k - 0.8, 0.1 * k - 0.2, 0.2}, {0, 0, 3}, {0, -1, 0}, kSize, 60);
    view.priors["albedo"] = Image(kSize.width, kSize.height, 3, 0.01f);
    view.priors["normal"] = Image(kSize.width, kSize.height, 3);
    const Vec3f n = cast<float>(view.camera.rotation_cam_from_world * wall_mirror().normal);
    for (std::size_t i = 0; i < kSize.num_pixels(); ++i) {
      put3(view.priors["normal"].data(), i, n);
      const int x = static_cast<int>(i) % kSize.width, y = static_cast<int>(i) / kSize.width;
      const Vec3d ray = view.camera.ray_in_world(x + 0.5, y + 0.5), eye = view.camera.center();
      const Vec3d at = eye + ((3 - eye.z) / ray.z) * ray;
      if (std::abs(at.x) > 1.4 || std::abs(at.y) > 0.9)
        put3(view.priors["albedo"].data(), i, Vec3f{0.5f, 0.5f, 0.5f});
    }
    scene.train.push_back(std::move(view));
  }
  // The photos of a mirror with that tint.
  void photograph_mirror(float tint) {
    PlaneMirrors mirrors;
    mirrors.planes = {wall_mirror()};
    mirrors.planes[0].tint = {tint, tint, tint};
    for (View& view : scene.train) {
      call.camera = view.camera;
      view.rgb = mirrors.put(
          {interface, transmission},
          call,
          Image(kSize.width, kSize.height, 1),
          Image(kSize.width, kSize.height, 3, 0.5f)
      );
    }
  }
  std::vector<MirrorPlane> candidates() {
    return candidate_mirrors(scene, {interface, transmission}, call, {});
  }
};

}  // namespace

TEST_CASE("A pane is one by its outlines or its likeness, a mirror by its likeness") {
  const FindMirrors settings;
  MirrorPlane plane = wall_mirror();
  plane.likeness = 0.5;
  CHECK_FALSE(is_mirroring(plane, settings));
  plane.outlined = 0.9;
  CHECK_FALSE(is_mirroring(plane, settings));
  plane.pane = true;
  plane.likeness = 0;
  CHECK(is_mirroring(plane, settings));
  plane.outlined = 0;
  CHECK_FALSE(is_mirroring(plane, settings));
  plane.likeness = 0.21;
  CHECK(is_mirroring(plane, settings));
}

TEST_CASE("A plane lies on another where its middle does and it faces the same way") {
  const PlaneFit settings{.tolerance = 0.1};
  const MirrorPlane wall = wall_mirror();
  MirrorPlane other = wall;
  other.center += Vec3d{1.3, 0.8, 0.09};
  CHECK(lies_on(other, wall, settings));
  CHECK_FALSE(lies_on(other.turned(), wall, settings));
  other.center.z += 0.02;
  CHECK_FALSE(lies_on(other, wall, settings));
  other.center = wall.center + Vec3d{1.5, 0, 0};
  CHECK_FALSE(lies_on(other, wall, settings));
}

TEST_CASE("A mirror is found where the photos show it, with its place and tint") {
  DarkWall wall;
  wall.photograph_mirror(0.8f);
  const auto planes = wall.candidates();
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].likeness > 0.95);
  CHECK(planes[0].likeness > FindMirrors().least_likeness);
  CHECK(planes[0].center.z == Approx(3).margin(0.01));
  CHECK(planes[0].half_width * planes[0].half_height == Approx(1.4 * 0.9).epsilon(0.1));
  CHECK(planes[0].tint[0] == Approx(0.8f).margin(0.02f));
}

TEST_CASE("A dark plane whose photos show something else is none, and flat photos say nothing") {
  DarkWall wall;
  std::uint64_t seed = 1;
  for (View& view : wall.scene.train) view.rgb = random_map(kSize, 3, 0, 1, seed++);
  auto planes = wall.candidates();
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].likeness < 0.3);
  for (View& view : wall.scene.train) view.rgb = Image(kSize.width, kSize.height, 3, 0.5f);
  planes = wall.candidates();
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].likeness == 0);
}

TEST_CASE("Without albedo priors nothing is looked for") {
  DarkWall wall;
  wall.photograph_mirror(1);
  for (View& view : wall.scene.train) view.priors = {};
  CHECK(wall.candidates().empty());
}

TEST_CASE("What stands where a mirror shows the room fades, what is beside it does not") {
  DarkWall wall;
  SurfelCloud cloud;
  cloud.resize(3);
  put3(cloud.means.data(), 0, Vec3f{0, 0, 5});  // in the mirror
  put3(cloud.means.data(), 1, Vec3f{5, 0, 5});  // behind the wall, seen by nobody through it
  put3(cloud.means.data(), 2, Vec3f{0, 0, 2});  // before it
  for (float& opacity : cloud.opacity_logits) opacity = 2;
  fade_behind(wall_mirror(), wall.scene.train, cloud);
  CHECK(cloud.opacity_logits[0] < -4);
  CHECK(cloud.opacity_logits[1] == 2);
  CHECK(cloud.opacity_logits[2] == 2);
}
