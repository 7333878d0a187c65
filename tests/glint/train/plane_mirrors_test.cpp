// SPDX-License-Identifier: MIT
// Plane mirrors: the camera behind one, the picture against surfels that stand mirrored behind the
// plane, its gradient by central differences, maps and files.
#include "glint/train/plane_mirrors.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/rng.h"
#include "glint/render/map_ops.h"
#include "glint/train/plane_mirrors_kernels.h"
#include "tests/support/check_array_gradient.h"
#include "tests/support/random_values.h"
#include "tests/support/same_bytes.h"

using namespace glint;
using namespace glint::test;
using Catch::Matchers::Contains;

namespace {

constexpr ImageSize kSize{24, 14};

Camera camera() {
  Camera camera = look_at({0.1, -0.2, 0.3}, {0.3, 0.1, 4}, {0, -1, 0}, kSize, 70);
  camera.cx += 0.7, camera.cy -= 0.4;
  return camera;
}

// Across the view, 4 m away, and a little turned.
MirrorPlane mirror() {
  MirrorPlane plane;
  plane.center = {0.3, 0.1, 4};
  plane.normal = normalize(Vec3d{0.1, -0.05, -1});
  plane.across = normalize(cross(plane.normal, Vec3d{0, 1, 0}));
  plane.half_width = 1.3, plane.half_height = 0.8;
  plane.tint = {0.9f, 0.8f, 0.7f};
  return plane;
}

// A wall of surfels across z = depth, of all colours.
void add_wall(SurfelCloud& cloud, double depth, double half, float transparency, Rng& rng) {
  for (double x = -half; x <= half; x += half / 5)
    for (double y = -half; y <= half; y += half / 5) {
      const std::size_t i = cloud.size();
      cloud.resize(i + 1);
      put3(cloud.means.data(), i, cast<float>(Vec3d{x, y, depth + 0.1 * x}));
      for (std::size_t k = 0; k < 3; ++k) cloud.sh_dc[3 * i + k] = rng.uniform(-1.2f, 1.2f);
      cloud.log_scales[2 * i] = static_cast<float>(std::log(half / 7));
      cloud.log_scales[2 * i + 1] = static_cast<float>(std::log(half / 9));
      for (std::size_t k = 0; k < 4; ++k)
        cloud.rotations[4 * i + k] = k == 0 ? 1.0f : rng.uniform(-0.2f, 0.2f);
      cloud.opacity_logits[i] = 2;
      for (std::size_t k = 0; k < cloud.num_extra(); ++k)
        cloud.extra_logits[cloud.num_extra() * i + k] = std::log(transparency / (1 - transparency));
    }
}

// A pane behind the camera, the wall behind it that the transmission set has, and another room
// behind the mirror, which nobody may see.
struct Fixture {
  TrainableSet interface, transmission;
  PlaneMirrors mirrors;
  MirrorsCall call;
  Image plain, weights;

  Fixture() {
    Rng rng(1);
    SurfelCloud room, behind;
    room.extra_names = {kTransparency, kSpecular};
    add_wall(room, -1.5, 4, 0.6f, rng);
    add_wall(room, 7, 6, 0.5f, rng);
    add_wall(behind, -3, 6, 0.5f, rng);
    add_wall(behind, 6, 6, 0.5f, rng);
    interface = TrainableSet(room, {});
    transmission = TrainableSet(behind, {});
    mirrors.planes = {mirror()};
    call.camera = camera();
    call.interface_degree = call.transmission_degree = 0;
    plain = random_map(rng, kSize, 3, 0, 1);
    weights = random_map(rng, kSize, 3, -1, 1);
  }
  MirroredSets sets() { return {interface, transmission}; }
  const Image& picture() {
    return mirrors.put(sets(), call, Image(kSize.width, kSize.height, 1), plain);
  }
  double loss() {
    const Image& image = picture();
    double sum = 0;
    for (std::size_t i = 0; i < image.values().size(); ++i)
      sum += static_cast<double>(weights.values()[i]) * static_cast<double>(image.values()[i]);
    return sum;
  }
};

// Every surfel where a mirror shows it.
SurfelCloud mirrored_cloud(SurfelCloud cloud, const MirrorPlane& plane) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::array<double, 4> q{};
    for (std::size_t k = 0; k < 4; ++k) q[k] = static_cast<double>(cloud.rotations[4 * i + k]);
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const Mat3d turn =
        rotation_of_unit(Vec4<double>{q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm});
    const auto turned = [&](Vec3d axis) {
      return axis - (2 * dot(plane.normal, axis)) * plane.normal;
    };
    const Vec3d u = turned(column(turn, 0)), v = turned(column(turn, 1)), w = cross(u, v);
    const Vec4<double> r =
        quaternion_from_rotation({{{u.x, v.x, w.x}, {u.y, v.y, w.y}, {u.z, v.z, w.z}}});
    const double turned_back[] = {r.w, r.x, r.y, r.z};
    for (std::size_t k = 0; k < 4; ++k)
      cloud.rotations[4 * i + k] = static_cast<float>(turned_back[k]);
    const Vec3d at = cast<double>(get3(cloud.means.data(), i));
    put3(cloud.means.data(), i, cast<float>(plane.mirrored(at)));
  }
  return cloud;
}

// The picture of the mirrored surfels behind the plane: Eq. 10 without what glass mirrors.
Image expected_picture(const Fixture& f, const Image& plane_depth) {
  const MirrorPlane plane = f.mirrors.planes[0];
  TrainableSet interface(mirrored_cloud(f.interface.cloud(), plane));
  TrainableSet transmission(mirrored_cloud(f.transmission.cloud(), plane));
  Image limit = plane_depth;
  for (float& z : limit.values()) z += z > 0 ? f.call.gap : 1e30f;
  const RasterOutput& near = interface.forward(f.call.camera, 0, {}, limit);
  Image depth, picture(kSize.width, kSize.height, 3);
  expected_depth_map(near, depth);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    depth.data()[i] = std::max(depth.data()[i], limit.data()[i]);
  const RasterOutput& far = transmission.forward(f.call.camera, 0, {}, depth);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i) {
    const float* pixel = near.features.data() + 5 * i;
    const Vec3f behind = get3(far.features.data(), i), front{pixel[0], pixel[1], pixel[2]};
    const float t = pixel[3];
    const auto& tint = plane.tint;
    put3(
        picture.data(), i, hadamard(Vec3f{tint[0], tint[1], tint[2]}, (1 - t) * front + t * behind)
    );
  }
  return picture;
}

}  // namespace

TEST_CASE("The camera in a mirror sees what the other sees in it, left and right exchanged") {
  const Camera eye = camera(), there = mirrored(eye, mirror());
  CHECK(determinant(there.rotation_cam_from_world) == Approx(1));
  CHECK(length(there.center() - mirror().mirrored(eye.center())) < 1e-12);
  Rng rng(2);
  for (int k = 0; k < 20; ++k) {
    const Vec3d p{rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3)};
    const Vec3d seen = eye.to_cam(mirror().mirrored(p)), from_there = there.to_cam(p);
    CHECK(from_there.z == Approx(seen.z));
    CHECK(there.project(from_there).x == Approx(kSize.width - eye.project(seen).x));
    CHECK(there.project(from_there).y == Approx(eye.project(seen).y));
  }
}

TEST_CASE("A mirror is in view where its front is") {
  const MirrorPlane plane = mirror();
  CHECK(is_in_view(plane, camera()));
  CHECK_FALSE(is_in_view(plane, look_at({0, 0, 0}, {0, 0, -4}, {0, -1, 0}, kSize, 70)));
  CHECK_FALSE(is_in_view(plane, look_at({0, 0, 8}, {0, 0, 4}, {0, -1, 0}, kSize, 70)));  // its back
}

TEST_CASE("A mirror shows the surfels as if they stood behind it") {
  Fixture f;
  const Image& picture = f.picture();
  const Image& seen = *f.mirrors.seen();
  MapSet maps;
  maps["depth"] = maps["transparency"] = Image(kSize.width, kSize.height, 1);
  maps["normal"] = Image(kSize.width, kSize.height, 3);
  f.mirrors.put_maps(maps);
  const Image expected = expected_picture(f, maps["depth"]);
  int in_mirror = 0;
  float shown = 0;
  for (std::size_t i = 0; i < seen.num_pixels(); ++i) {
    const bool is_seen = seen.data()[i] > 0;
    in_mirror += is_seen ? 1 : 0;
    const Vec3f value = get3(picture.data(), i);
    const Vec3f wanted = get3((is_seen ? expected : f.plain).data(), i);
    CHECK(length(value - wanted) < (is_seen ? 2e-4f : 1e-9f));
    if (is_seen) shown = std::max(shown, length(value));
    // The point of the plane that the pixel's centre meets, and no other pixel.
    const int x = static_cast<int>(i) % kSize.width, y = static_cast<int>(i) / kSize.width;
    const double z = static_cast<double>(maps["depth"].data()[i]);
    const Vec3d at = f.call.camera.to_world(z * f.call.camera.ray_in_cam(x + 0.5, y + 0.5));
    if (is_seen) CHECK(std::abs(mirror().signed_distance(at)) < 1e-5);
  }
  CHECK(in_mirror > 60);
  CHECK(in_mirror < 300);
  CHECK(shown > 0.3f);
}

TEST_CASE("What stands before a mirror hides it, what the photos draw behind it does not") {
  Fixture f;
  Image depth(kSize.width, kSize.height, 1);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) depth.at(x, y) = x < kSize.width / 2 ? 2.5f : 6.0f;
  f.mirrors.put(f.sets(), f.call, depth, f.plain);
  int left = 0, right = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      (x < kSize.width / 2 ? left : right) += f.mirrors.seen()->at(x, y) > 0 ? 1 : 0;
  CHECK(left == 0);
  CHECK(right > 30);
}

TEST_CASE("A picture without a mirror in view is the same image") {
  Fixture f;
  f.call.camera = look_at({0, 0, 0}, {0, 0, -4}, {0, -1, 0}, kSize, 70);
  CHECK(&f.picture() == &f.plain);
  CHECK(f.mirrors.seen() == nullptr);
  CHECK(&f.mirrors.put_vjp(f.sets(), f.weights, true) == &f.weights);
}

TEST_CASE("Mirrors that are taken away are seen no more") {
  Fixture f;
  CHECK(&f.picture() != &f.plain);
  f.mirrors.planes.clear();
  CHECK(&f.picture() == &f.plain);
  CHECK(&f.mirrors.put_vjp(f.sets(), f.weights, true) == &f.weights);
}

TEST_CASE("Gradients reach the sets through a mirror, and the picture outside of it") {
  Fixture f;
  f.picture();
  const Image dL_dplain = f.mirrors.put_vjp(f.sets(), f.weights, true);
  const Image seen = *f.mirrors.seen();
  for (std::size_t i = 0; i < dL_dplain.values().size(); ++i)
    CHECK(dL_dplain.values()[i] == (seen.data()[i / 3] > 0 ? 0 : f.weights.values()[i]));
  const auto check = [&](TrainableSet& set, FloatArray SurfelCloud::*array, const char* name) {
    check_array_gradient([&] { return f.loss(); }, set, array, name);
  };
  check(f.interface, &SurfelCloud::sh_dc, "colours of the interface");
  check(f.interface, &SurfelCloud::extra_logits, "t of the interface");
  check(f.interface, &SurfelCloud::opacity_logits, "opacities of the interface");
  check(f.transmission, &SurfelCloud::sh_dc, "colours behind");
}

TEST_CASE("A frozen interface gets no gradient through a mirror") {
  Fixture f;
  f.picture();
  f.mirrors.put_vjp(f.sets(), f.weights, false);
  for (const float value : f.interface.gradient().sh_dc) CHECK(value == 0);
}

TEST_CASE("Mirrors are written and read, and other texts are errors that say what is wrong") {
  std::vector<MirrorPlane> planes{mirror(), mirror()};
  planes[1].pane = true;
  planes[1].likeness = 0.4, planes[1].outlined = 0.8;
  const std::string text = mirrors_text(planes);
  const auto read = mirrors_of(text, "mirrors.json");
  REQUIRE(read.size() == 2);
  CHECK_FALSE(read[0].pane);
  CHECK(read[1].pane);
  CHECK(read[1].likeness == 0.4);
  CHECK(read[1].outlined == 0.8);
  CHECK(mirrors_text(read) == text);
  CHECK(mirrors_of(mirrors_text({}), "f").empty());
  const auto error_of = [](const std::string& bad) {
    try {
      mirrors_of(bad, "run/mirrors.json");
    } catch (const Error& error) {
      CHECK(error.code() == ExitCode::kBadPrediction);
      return std::string(error.what());
    }
    return std::string("none");
  };
  CHECK_THAT(error_of("{"), Contains("run/mirrors.json: expected a JSON list"));
  CHECK_THAT(error_of("[1]"), Contains("expected a list of objects"));
  CHECK_THAT(error_of("[{}]"), Contains("is no rectangle"));
  MirrorPlane flat = mirror();
  flat.half_height = 0;
  CHECK_THAT(error_of(mirrors_text({flat})), Contains("sides above 0"));
  flat = mirror();
  flat.normal = {0, 0, 2};
  CHECK_THAT(error_of(mirrors_text({flat})), Contains("unit vectors"));
}
