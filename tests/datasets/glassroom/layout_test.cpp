// SPDX-License-Identifier: MIT
// Layouts of the five rooms and of the scenes beyond first order: nothing stands in anything else,
// cameras see the container, and what the scene is for.
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "datasets/glassroom/check_panes.h"
#include "datasets/glassroom/glassroom_scene.h"
#include "datasets/glassroom/scene_programs.h"
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

void check_layout(const GlassRoomScene& scene) {
  check_items(scene.room);
  check_meshes(scene.room);
  check_cameras(scene);
  check_panes(scene.room.scene);
  CHECK(scene.room.bounds().contains(scene.container_bounds));
  for (const PlacedItem& item : scene.room.items)
    CHECK_FALSE(scene.container_bounds.overlaps(item.bounds));
}

// Vertices of a mesh in a case's frame.
Bounds bounds_in(const Pose& pose, const TraceMesh& mesh) {
  Bounds bounds;
  for (const Vec3f vertex : mesh.vertices)
    bounds.include(transpose_times(pose.rotation, vertex - pose.translation));
  return bounds;
}

Bounds inside_of(const ContainerShape& shape) {
  const Vec3f half = 0.5f * shape.size;
  return {.low = {-half.x, -half.y, 0}, .high = {half.x, half.y, shape.size.z}};
}

// Share of the views' pixels whose first surface, or what is behind panes, is a mirror.
std::vector<double> mirror_shares(const GlassRoomScene& scene) {
  std::vector<double> shares;
  for (const Camera& full : scene.cameras) {
    const Camera camera = resized(full, {32, 18});
    int mirrors = 0;
    for (int y = 0; y < 18; ++y)
      for (int x = 0; x < 32; ++x)
        mirrors += scene.tracer
                       ->first_hit(
                           cast<float>(camera.center()),
                           cast<float>(camera.ray_in_world(x + 0.5, y + 0.5)),
                           true
                       )
                       .mirror;
    shares.push_back(mirrors / (32.0 * 18));
  }
  return shares;
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

TEST_CASE("A case stands in a case, with things in both and nothing in anything else") {
  const auto scene = build_glassroom_scene(small("nested_1"));
  check_layout(*scene);
  REQUIRE(scene->inner);
  const Pose &outer = scene->settled.container, &inner = scene->settled.inner_case;
  CHECK(scene->settled.objects.size() >= 3);
  CHECK(scene->settled.inner_objects.size() == 3);
  std::size_t frames = 0, things = 0, inside = 0;
  const Bounds within = inside_of(scene->container), within_inner = inside_of(*scene->inner);
  const std::size_t first_object =
      scene->room.scene.meshes.size() - 7 - 3 - 7 - scene->settled.objects.size();
  for (std::size_t i = first_object; i < scene->room.scene.meshes.size(); ++i) {
    const TraceMesh& mesh = scene->room.scene.meshes[i];
    INFO(mesh.name);
    if (mesh.name == "pane") continue;
    CHECK(within.grown(1e-3f).contains(bounds_in(outer, mesh)));
    frames += mesh.name == "frame";
    if (mesh.name == "frame") continue;
    ++things;
    // All of it in the inner case, or all of it outside.
    std::size_t in = 0;
    for (const Vec3f vertex : mesh.vertices)
      in += within_inner.grown(-0.004f).contains(
          transpose_times(inner.rotation, vertex - inner.translation)
      );
    CHECK((in == 0 || in == mesh.vertices.size()));
    inside += in > 0;
  }
  CHECK(frames == 2);
  CHECK(things == 3 + scene->settled.objects.size());
  CHECK(inside == 3);
}

TEST_CASE("Cameras see the case from before and from behind the shop window, and keep off it") {
  GlassRoomOptions options = small("window_1");
  options.views = 64;
  const auto scene = build_glassroom_scene(options);
  check_layout(*scene);
  const auto window =
      std::find_if(scene->room.items.begin(), scene->room.items.end(), [](const PlacedItem& item) {
        return item.kind == "shop window";
      });
  REQUIRE(window != scene->room.items.end());
  CHECK(window->bounds.size().x == Approx(3.1f));
  CHECK(window->bounds.size().z == Approx(2));
  int before = 0;
  for (const Camera& camera : scene->cameras) {
    const Vec3f eye = cast<float>(camera.center());
    before += eye.y < window->bounds.low.y;
    CHECK_FALSE(window->bounds.grown(0.1f).contains(eye));
  }
  CHECK(before >= 8);
  CHECK(before <= 48);
}

TEST_CASE("The mirror is well visible from a good share of the views") {
  const auto scene = build_glassroom_scene(small("mirror_1"));
  check_layout(*scene);
  const std::vector<double> shares = mirror_shares(*scene);
  const auto good = std::ranges::count_if(shares, [](double share) { return share > 0.1; });
  CHECK(2 * good >= static_cast<std::ptrdiff_t>(shares.size()));
}

TEST_CASE("Tints differ from pane to pane") {
  const auto scene = build_glassroom_scene(small("tinted_1"));
  check_layout(*scene);
  std::set<std::array<float, 3>> tints;
  for (const Material& material : scene->room.scene.materials)
    if (material.kind == MaterialKind::kThinDielectric)
      tints.insert({material.tint.x, material.tint.y, material.tint.z});
  CHECK(tints.size() == 6);
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
      Catch::Contains("room_9") && Catch::Contains("room_5") && Catch::Contains("tinted_1")
  );
  CHECK_THROWS_WITH(build_glassroom_scene({.width = 0}), Catch::Contains("width"));
  CHECK_THROWS_WITH(build_glassroom_scene({.views = 1}), Catch::Contains("views"));
  CHECK_THROWS_WITH(build_glassroom_scene({.spp = 0}), Catch::Contains("spp"));
}
