// SPDX-License-Identifier: MIT
// Layouts of the five rooms: nothing stands in anything else, cameras see the container.
#include <catch2/catch.hpp>

#include <cmath>
#include <set>

#include "datasets/glassroom/glassroom_scene.h"
#include "glint/core/error.h"
#include "glint/core/progress.h"

using namespace glint;

namespace {

GlassRoomOptions small(const std::string& name) {
  return {.scene = name, .width = 64, .height = 36, .views = 24, .spp = 1};
}

// Corners of the container that the camera has in its image.
int corners_in_image(const Bounds& box, const Camera& camera) {
  int inside = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3d corner{
        (k & 1) ? box.low.x : box.high.x,
        (k & 2) ? box.low.y : box.high.y,
        (k & 4) ? box.low.z : box.high.z};
    const Vec3d in_cam = camera.to_cam(corner);
    if (in_cam.z <= 0) continue;
    const Vec2d p = camera.project(in_cam);
    inside += p.x >= 0 && p.y >= 0 && p.x < camera.width && p.y < camera.height;
  }
  return inside;
}

void check_items(const RoomModel& room) {
  const Bounds inside = room.bounds();
  for (std::size_t i = 0; i < room.items.size(); ++i) {
    INFO(room.items[i].kind << " on wall " << room.items[i].wall);
    CHECK(inside.contains(room.items[i].bounds));
    for (std::size_t j = 0; j < i; ++j)
      CHECK_FALSE(room.items[i].bounds.overlaps(room.items[j].bounds));
  }
}

void check_meshes(const RoomModel& room) {
  const Bounds shell = room.bounds().grown(1e-4f);
  for (const TraceMesh& mesh : room.scene.meshes) {
    INFO(mesh.name);
    CHECK(shell.contains(bounds_of(mesh)));
  }
}

void check_cameras(const GlassRoomScene& scene) {
  for (const Camera& camera : scene.cameras) {
    const Vec3f eye = cast<float>(camera.center());
    INFO("camera at " << eye.x << " " << eye.y << " " << eye.z);
    CHECK(scene.room.bounds().grown(-0.15f).contains(eye));
    CHECK_FALSE(scene.container_bounds.contains(eye));
    for (const PlacedItem& item : scene.room.items) CHECK_FALSE(item.bounds.contains(eye));
    CHECK(nearest_surface(*scene.tracer, camera.center()) > 0.15);
    CHECK(container_visibility(*scene.tracer, scene.container_bounds, camera) >= 0.7);
    CHECK(corners_in_image(scene.container_bounds, camera) >= 4);
  }
}

}  // namespace

TEST_CASE("All five rooms have valid layouts, cameras and contents") {
  set_quiet(true);
  std::set<float> widths;
  for (const RoomProgram& program : room_programs()) {
    INFO(program.name);
    const auto scene = build_glassroom_scene(small(std::string(program.name)));
    check_items(scene->room);
    check_meshes(scene->room);
    check_cameras(*scene);
    CHECK(scene->cameras.size() == 24);
    CHECK(scene->glass_share >= 0.15);
    CHECK(scene->glass_share <= 0.40);
    Bounds reach = scene->container_bounds;
    for (const PlacedItem& item : scene->room.items) CHECK_FALSE(reach.overlaps(item.bounds));
    CHECK(scene->room.bounds().contains(scene->container_bounds));
    widths.insert(scene->room.size.x);
  }
  CHECK(widths.size() == 5);
}

TEST_CASE("The camera path is continuous and goes round the container") {
  GlassRoomOptions options = small("room_1");
  options.views = 120;
  const auto scene = build_glassroom_scene(options);
  const Vec3d middle = cast<double>(scene->container_bounds.center());
  std::set<int> octants;
  std::size_t jumps = 0;
  for (std::size_t i = 0; i < scene->cameras.size(); ++i) {
    const Vec3d eye = scene->cameras[i].center() - middle;
    const Vec3d next = scene->cameras[(i + 1) % scene->cameras.size()].center() - middle;
    octants.insert(static_cast<int>(std::floor((std::atan2(eye.y, eye.x) + 3.1416) / 0.7855)));
    jumps += length(next - eye) > 0.5;
  }
  CHECK(octants.size() >= 7);
  CHECK(jumps <= 6);  // gaps where poses were dropped
}

TEST_CASE("The exposure leaves few pixels clipped") {
  const auto scene = build_glassroom_scene(small("room_3"));
  const float exposure = fit_exposure(*scene, 1);
  std::size_t clipped = 0, total = 0;
  for (std::size_t i = 0; i < scene->cameras.size(); i += 4) {
    const auto out = scene->tracer->render(scene->cameras[i], {.spp = 8, .seed = 5, .view = i});
    for (std::size_t p = 0; p < out.radiance.num_pixels(); ++p, ++total) {
      const float* rgb = out.radiance.data() + 3 * p;
      clipped += std::max({rgb[0], rgb[1], rgb[2]}) * exposure > 1;
    }
  }
  CHECK(static_cast<double>(clipped) < 0.08 * static_cast<double>(total));
}

TEST_CASE("Unknown rooms and absurd sizes are usage errors") {
  CHECK_THROWS_WITH(
      build_glassroom_scene({.scene = "room_9"}),
      Catch::Contains("room_9") && Catch::Contains("room_5")
  );
  CHECK_THROWS_WITH(build_glassroom_scene({.width = 0}), Catch::Contains("width"));
  CHECK_THROWS_WITH(build_glassroom_scene({.views = 1}), Catch::Contains("views"));
  CHECK_THROWS_WITH(build_glassroom_scene({.spp = 0}), Catch::Contains("spp"));
}
