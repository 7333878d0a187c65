// SPDX-License-Identifier: MIT
#include "glint/scene/camera_path.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "glint/core/error.h"
#include "glint/scene/camera_path_file.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr ImageSize kSize{64, 36};
const Vec3d kLow{-4, -4, -4}, kHigh{4, 4, 4};

// On a circle of radius 2 about the z axis at height 0.5, all looking at `target`.
std::vector<Camera> ring(int count, Vec3d target) {
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double angle = 0.7 + 2 * std::numbers::pi * i / count;
    const Vec3d eye{2 * std::cos(angle), 2 * std::sin(angle), 0.5};
    cameras.push_back(look_at(eye, target, {0, 0, 1}, kSize, 60));
  }
  return cameras;
}

double distance(Vec3d a, Vec3d b) { return length(a - b); }

// Largest difference of rotation and centre.
double pose_difference(const Camera& a, const Camera& b) {
  double largest = distance(a.center(), b.center());
  for (int i = 0; i < 3; ++i)
    largest = std::max(
        largest, distance(a.rotation_cam_from_world.rows[i], b.rotation_cam_from_world.rows[i])
    );
  return largest;
}

void check_orbit(const Orbit& orbit, const std::vector<Camera>& frames) {
  for (const Camera& camera : frames) {
    const Vec3d from_center = camera.center() - orbit.center;
    CHECK(length(from_center) == Approx(orbit.radius).epsilon(1e-12));
    CHECK(std::abs(dot(from_center, orbit.axis)) < 1e-12 * orbit.radius);
    const Vec3d seen = camera.to_cam(orbit.target);
    CHECK(seen.z > 0);
    CHECK(std::hypot(seen.x, seen.y) < 1e-9);
  }
}

}  // namespace

TEST_CASE("an orbit of cameras on a circle is that circle") {
  const Vec3d target{0, 0, 0.1};
  const auto cameras = ring(9, target);
  const Orbit orbit = fit_orbit(cameras, kLow, kHigh);
  CHECK(distance(orbit.target, target) < 1e-9);
  CHECK(distance(orbit.center, {0, 0, 0.5}) < 1e-9);
  CHECK(distance(orbit.axis, {0, 0, 1}) < 1e-9);
  CHECK(orbit.radius == Approx(2));
  const auto frames = orbit_cameras(orbit, cameras.front(), 36);
  REQUIRE(frames.size() == 36);
  check_orbit(orbit, frames);
  CHECK(pose_difference(frames[0], cameras[0]) < 1e-9);
  CHECK(pose_difference(frames[4], cameras[1]) < 1e-9);  // a ninth of the turn
  CHECK(frames[7].size() == kSize);
  CHECK(frames[7].fx == cameras[0].fx);
}

TEST_CASE("cameras that look outwards or the same way orbit about the middle of the box") {
  std::vector<Camera> out, along;
  for (const Camera& camera : ring(8, {0, 0, 0.5})) {
    const Vec3d eye = camera.center();
    out.push_back(look_at(eye, 2.0 * eye, {0, 0, 1}, kSize, 60));
    along.push_back(look_at(eye, eye + Vec3d{1, 0, 0}, {0, 0, 1}, kSize, 60));
  }
  const Vec3d middle{1, 1, 0};
  for (const auto& cameras : {out, along}) {
    const Orbit orbit = fit_orbit(cameras, {-3, -3, -1}, {5, 5, 1});
    CHECK(distance(orbit.target, middle) < 1e-9);
    check_orbit(orbit, orbit_cameras(orbit, cameras.front(), 12));
  }
}

TEST_CASE("cameras in a row orbit level with their up direction") {
  std::vector<Camera> cameras;
  for (int i = 0; i < 5; ++i)
    cameras.push_back(look_at({0.5 * i - 1, -2, 0.3}, {0, 0, 0}, {0, 0, 1}, kSize, 60));
  const Orbit orbit = fit_orbit(cameras, kLow, kHigh);
  CHECK(distance(orbit.target, {0, 0, 0}) < 1e-6);
  CHECK(orbit.axis.z > 0.95);
  check_orbit(orbit, orbit_cameras(orbit, cameras.front(), 12));
}

TEST_CASE("one camera has an orbit, none has not") {
  const auto cameras = ring(1, {0, 0, 0});
  check_orbit(
      fit_orbit(cameras, kLow, kHigh),
      orbit_cameras(fit_orbit(cameras, kLow, kHigh), cameras.front(), 5)
  );
  CHECK_THROWS_AS(fit_orbit({}, kLow, kHigh), Error);
}

TEST_CASE("a spline passes through its keys and turns smoothly between them") {
  auto keys = ring(7, {0.3, 0, 0.2});
  keys[3].translation_cam_from_world += Vec3d{0.1, 0.4, -0.2};
  const CameraSpline spline(keys);
  REQUIRE(spline.knots().size() == keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    CHECK(pose_difference(spline.at(spline.knots()[i]), keys[i]) < 1e-9);
  // Same slope to either side of a key; rotations are rotations.
  constexpr double kStep = 1e-5;
  for (std::size_t i = 1; i + 1 < keys.size(); ++i) {
    const double t = spline.knots()[i];
    const Vec3d before = spline.at(t).center() - spline.at(t - kStep).center();
    const Vec3d after = spline.at(t + kStep).center() - spline.at(t).center();
    CHECK(distance(before, after) < 1e-3 * length(after));
    const Camera between = spline.at(0.5 * (t + spline.knots()[i - 1]));
    CHECK(determinant(between.rotation_cam_from_world) == Approx(1));
  }
  const auto frames = spline.frames(50);
  REQUIRE(frames.size() == 50);
  CHECK(pose_difference(frames.front(), keys.front()) < 1e-9);
  CHECK(pose_difference(frames.back(), keys.back()) < 1e-9);
  for (std::size_t i = 1; i < frames.size(); ++i)
    CHECK(pose_difference(frames[i], frames[i - 1]) < 0.6);
}

TEST_CASE("a spline through equal steps along a line is the line") {
  std::vector<Camera> keys;
  for (int i = 0; i < 4; ++i)
    keys.push_back(look_at({1.0 * i, 0, 0}, {1.0 * i, 1, 0}, {0, 0, 1}, kSize, 60));
  const auto frames = CameraSpline(keys).frames(13);
  for (int i = 0; i < 13; ++i)
    CHECK(distance(frames[static_cast<std::size_t>(i)].center(), {0.25 * i, 0, 0}) < 1e-9);
}

TEST_CASE("keys that repeat are left out, and one alone is no path") {
  const auto ring_keys = ring(3, {0, 0, 0});
  std::vector<Camera> keys{ring_keys[0], ring_keys[0], ring_keys[1], ring_keys[1], ring_keys[2]};
  CHECK(CameraSpline(keys).knots().size() == 3);
  CHECK_THROWS_AS(CameraSpline({ring_keys[0], ring_keys[0]}), Error);
  CHECK_THROWS_AS(CameraSpline({}), Error);
}

TEST_CASE("another size keeps the horizontal field of view and the middle") {
  Camera camera = look_at({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {64, 36}, 60);
  camera.cy += 2;
  const Camera large = with_size(camera, {128, 128});
  CHECK(large.fx == Approx(2 * camera.fx));
  CHECK(large.fy == Approx(2 * camera.fy));
  CHECK(large.cx == Approx(64));
  CHECK(large.cy == Approx(64 + 4));
}

TEST_CASE("a path comes back from its file") {
  const test::TempFolder folder;
  const fs::path file = folder / "path.json";
  CameraPath path{CameraSpline(ring(5, {0.1, 0.2, 0.3})).frames(11), 30};
  write_camera_path(file, path);
  const CameraPath read = read_camera_path(file, {});
  REQUIRE(read.cameras.size() == 11);
  CHECK(read.fps == 30);
  for (std::size_t i = 0; i < 11; ++i) {
    CHECK(pose_difference(read.cameras[i], path.cameras[i]) < 1e-6);
    CHECK(read.cameras[i].fx == Approx(path.cameras[i].fx));
    CHECK(read.cameras[i].size() == kSize);
  }
}

TEST_CASE("a camera comes back from its JSON, with another's lens where it has none") {
  const Camera camera = ring(5, {0.1, 0.2, 0.3}).at(2);
  const Json json = camera_to_json(camera);
  const Camera read = camera_from_json(json, {}, "camera");
  CHECK(pose_difference(read, camera) < 1e-6);
  CHECK(read.size() == camera.size());
  CHECK(read.fx == Approx(camera.fx));
  CHECK(read.cy == Approx(camera.cy));
  Camera lens = camera;
  lens.fx = 2 * camera.fx;
  const Json pose = {{"world_from_cam", json["world_from_cam"]}};
  CHECK(camera_from_json(pose, lens, "camera").fx == lens.fx);
  CHECK_THROWS_WITH(
      camera_from_json(Json::object(), lens, "cameras[3]"), Catch::Contains("cameras[3]")
  );
}

TEST_CASE("transforms.json and the viewer's camera_path.json are read, with OpenGL axes") {
  const test::TempFolder folder;
  // At (1, 2, 3), looking along -z of the world with y up: the identity in OpenGL's axes.
  write_file(
      folder / "transforms.json",
      R"({"w": 64, "h": 36, "camera_angle_x": 1.5707963267948966, "frames": [{"file_path": "a.png",
          "transform_matrix": [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]}]})"
  );
  write_file(
      folder / "camera_path.json",
      R"({"render_width": 64, "render_height": 36, "fps": 24, "camera_path": [{"fov": 90,
          "camera_to_world": [1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1]}]})"
  );
  for (const char* name : {"transforms.json", "camera_path.json"}) {
    const CameraPath path = read_camera_path(folder / name, {});
    REQUIRE(path.cameras.size() == 1);
    const Camera& camera = path.cameras[0];
    CHECK(distance(camera.center(), {1, 2, 3}) < 1e-12);
    CHECK(distance(camera.to_cam({1, 2, 1}), {0, 0, 2}) < 1e-12);
    CHECK(distance(camera.to_cam({1, 3, 1}), {0, -1, 2}) < 1e-12);
    CHECK(camera.size() == kSize);
    CHECK(camera.fx == Approx(name[0] == 't' ? 32 : 18));
  }
}

TEST_CASE("a file without a lens has that of the data") {
  const test::TempFolder folder;
  write_file(
      folder / "path.json", R"({"frames": [{"world_from_cam": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})"
  );
  const Camera lens = ring(1, {0, 0, 0})[0];
  const Camera camera = read_camera_path(folder / "path.json", lens).cameras.at(0);
  CHECK(camera.size() == lens.size());
  CHECK(camera.fx == lens.fx);
}

TEST_CASE("files that are no path are refused by name") {
  const test::TempFolder folder;
  const char* bad[] = {
      "[]",
      "{}",
      R"({"frames": []})",
      R"({"frames": [1]})",
      R"({"frames": [{}]})",
      R"({"frames": [{"world_from_cam": [1, 2]}]})",
      R"({"frames": [{"world_from_cam": [["a",0,0,0],[0,1,0,0],[0,0,1,0]]}]})",
      R"({"frames": [{"world_from_cam": [[2,0,0,0],[0,2,0,0],[0,0,2,0]]}]})",
      R"({"frames": [{"world_from_cam": [[1,0,0,0],[0,1,0,0],[0,0,-1,0]]}]})",
      R"({"width": 1e6, "height": 4, "fx": 4, "frames": [{"world_from_cam": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})",
      R"({"width": 4, "height": 4, "frames": [{"world_from_cam": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})",
      R"({"width": -4, "height": 4, "fx": 4, "frames": [{"world_from_cam": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})"};
  const Camera lens = ring(1, {0, 0, 0})[0];
  for (const char* text : bad) {
    INFO(text);
    write_file(folder / "path.json", text);
    CHECK_THROWS_WITH(read_camera_path(folder / "path.json", lens), Catch::Contains("path.json"));
  }
  CHECK_THROWS_AS(read_camera_path(folder / "none.json", lens), Error);
}
