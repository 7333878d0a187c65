// SPDX-License-Identifier: MIT
#include "datasets/glassroom/path_tracer.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <numbers>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "tests/datasets/glassroom/trace_scenes.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr double kPi = std::numbers::pi;

PathTracerSettings settings(int spp, int max_bounces = 200, bool next_event_estimation = true) {
  PathTracerSettings s;
  s.spp = spp;
  s.max_bounces = max_bounces;
  s.next_event_estimation = next_event_estimation;
  return s;
}

// Mean of the first channel over a narrow view: a value and its standard error over 16 seeds.
MeanAndError look(const TraceScene& scene, Vec3d eye, Vec3d target, const PathTracerSettings& s) {
  const PathTracer tracer(scene);
  return mean_over_seeds(tracer, narrow_camera(eye, target), s, 16);
}

// Direct light at the origin of the floor z = 0 (normal +z) from a square of half side `half` at
// height z around (x, 0), times `factor(direction)`: midpoint rule.
double irradiance_from_square(
    double radiance, double z, double half, double x, const std::function<double(Vec3d)>& factor
) {
  constexpr int kCells = 400;
  double sum = 0;
  for (int i = 0; i < kCells * kCells; ++i) {
    const Vec3d p{
        x - half + 2 * half * (i % kCells + 0.5) / kCells,
        -half + 2 * half * (i / kCells + 0.5) / kCells,
        z};
    const double distance2 = length2(p), cosine = z / std::sqrt(distance2);
    sum += cosine * cosine / distance2 * factor((1 / std::sqrt(distance2)) * p);
  }
  return radiance * sum * (4 * half * half) / (kCells * kCells);
}

double slab(double cosine, double ior) {
  return static_cast<double>(thin_slab_reflectance(float(cosine), float(ior)));
}

bool same_bytes(const Image& a, const Image& b) {
  return std::equal(a.values().begin(), a.values().end(), b.values().begin(), b.values().end());
}

template <class F>
std::string message_of(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("A white convex object vanishes in a white environment, whatever its material") {
  // Plastic and conductor conserve energy within 0.3 % (bsdf_test); the rest is standard error.
  for (const auto kind :
       {MaterialKind::kDiffuse, MaterialKind::kRoughConductor, MaterialKind::kRoughPlastic}) {
    TraceScene scene;
    scene.environment = {1, 1, 1};
    add_box(scene, add_material(scene, glossy(kind, 1, 0.5f)), {-1, -1, -1}, {1, 1, 1});
    const Camera camera = look_at({4, 3, 2}, {0, 0, 0}, {0, 0, 1}, {8, 8}, 20);
    const MeanAndError result = mean_over_seeds(PathTracer(scene), camera, settings(64), 8);
    CAPTURE(int(kind), result.error);
    CHECK(result.mean == Approx(1).margin(3e-3 + 4 * result.error));
    if (kind == MaterialKind::kDiffuse) CHECK(result.mean == Approx(1).margin(1e-6));
  }
}

TEST_CASE(
    "No ray meets the surface that it leaves, on large and slanted triangles far from the origin"
) {
  TraceScene scene;
  scene.environment = {1, 1, 1};
  add_quad(
      scene,
      add_material(scene, diffuse(0.5f)),
      {{{-9, -11, 3}, {12, -8, 5.5f}, {13, 10, 13.5f}, {-8, 7, 11}}}
  );
  const Camera camera = look_at({1, -20, 14}, {2, 0, 8.5}, {0, 0, 1}, {64, 36}, 50);
  const PathTracerOutput out = PathTracer(scene).render(camera, settings(16));
  // One bounce into the environment: 0.5 where all samples hit, towards 1 at the edges; another
  // bounce on the surface itself would give less.
  int num_hits = 0;
  for (int i = 0; i < 64 * 36; ++i) {
    const int x = i % 64, y = i / 64;
    if (out.maps["depth"].at(x, y) == 0.0f) continue;
    ++num_hits;
    CHECK(out.radiance.at(x, y) >= 0.5f - 1e-6f);
  }
  CHECK(num_hits > 500);
}

TEST_CASE("Glass without tint vanishes in a white environment") {
  TraceScene scene;
  scene.environment = {1, 1, 1};
  add_box(scene, add_material(scene, glass(1.5f)), {-1, -1, -1}, {1, 1, 1});
  const Camera camera = look_at({4, 3, 2}, {0, 0, 0}, {0, 0, 1}, {8, 8}, 20);
  const Image image = PathTracer(scene).render(camera, settings(16)).radiance;
  for (const float value : image.values()) CHECK(value == Approx(1).epsilon(1e-5));
}

TEST_CASE("A closed room of glowing diffuse walls has radiance e / (1 - albedo)") {
  TraceScene scene;
  add_box(scene, add_material(scene, emitter(1, 0.5f)), {-1, -2, 0}, {1, 2, 3});
  const Camera camera = look_at({0.5, 0.5, 1}, {0, -2, 1.5}, {0, 0, 1}, {8, 8}, 80);
  for (const bool nee : {true, false}) {
    const MeanAndError r = mean_over_seeds(PathTracer(scene), camera, settings(64, 200, nee), 16);
    CAPTURE(nee, r.error);
    CHECK(r.error < 0.01);
    CHECK(r.mean == Approx(2).margin(4 * r.error));
  }
}

TEST_CASE("A floor under a square light has the radiance of the form factor, at any distance") {
  // Differential element below the centre of a parallel square: four corner quadrants. Far from the
  // origin, where a shadow ray's margins are largest against a small distance.
  constexpr double kRadiance = 3, kAlbedo = 0.6, kFloor = 2.8, x = 0.4;
  const double s = std::sqrt(1 + x * x);
  const double form_factor = 4 / (2 * kPi) * 2 * (x / s * std::atan(x / s));
  for (const double height : {1.2, 0.2, 0.05}) {
    TraceScene scene;
    add_horizontal(scene, add_material(scene, diffuse(float(kAlbedo))), float(kFloor), 5);
    const int light = add_material(scene, emitter(float(kRadiance)));
    add_horizontal(scene, light, float(kFloor + height), float(x * height));
    for (const bool nee : {true, false}) {
      const auto r = look(scene, {3, 0, kFloor + 1}, {0, 0, kFloor}, settings(4096, 1, nee));
      CAPTURE(height, nee, r.error);
      CHECK(r.error < 0.01);
      CHECK(r.mean == Approx(kAlbedo * kRadiance * form_factor).epsilon(1e-3).margin(4 * r.error));
    }
  }
}

TEST_CASE("Light through a pane reaches the floor with the pane's transmittance at every angle") {
  constexpr double kIor = 1.52, kTint = 0.9, kAlbedo = 0.6;
  const double irradiance =
      irradiance_from_square(3, 1.2, 0.7, 0, [](Vec3d w) { return (1 - slab(w.z, kIor)) * kTint; });
  TraceScene scene;
  add_horizontal(scene, add_material(scene, diffuse(float(kAlbedo))), 0, 5);
  add_horizontal(scene, add_material(scene, emitter(3)), 1.2f, 0.7f);
  add_horizontal(scene, add_material(scene, glass(float(kIor), {0.9f, 1, 1})), 0.8f, 2.0f);
  for (const bool nee : {true, false}) {
    const auto tracer = PathTracer(scene);
    // Red only: the pane is tinted there.
    double sum = 0, sum2 = 0;
    constexpr int kSeeds = 16;
    for (int i = 0; i < kSeeds; ++i) {
      auto s = settings(4096, 1, nee);
      s.seed = static_cast<std::uint64_t>(i);
      const double v =
          double(tracer.render(narrow_camera({4, 0, 0.5}, {0, 0, 0}), s).radiance.at(0, 0));
      sum += v / kSeeds;
      sum2 += v * v / kSeeds;
    }
    const double error = std::sqrt(std::max(0.0, sum2 - sum * sum) / (kSeeds - 1));
    CAPTURE(nee, error);
    CHECK(error < 0.01);
    CHECK(sum == Approx(kAlbedo / kPi * irradiance).margin(4 * error + 1e-4));
  }
}

TEST_CASE("Light mirrored by a pane reaches the floor as from the mirrored light") {
  // A vertical pane at x = 1 mirrors the light at x = 0.4 to x = 1.6; a screen hides the light
  // itself.
  constexpr double kIor = 1.8, kAlbedo = 0.8, kHalf = 0.3, kHeight = 1.5;
  const double irradiance =
      irradiance_from_square(5, kHeight, kHalf, 1.6, [](Vec3d w) { return slab(w.x, kIor); });
  TraceScene scene;
  add_horizontal(scene, add_material(scene, diffuse(float(kAlbedo))), 0, 0.05f);
  add_horizontal(scene, add_material(scene, emitter(5)), float(kHeight), float(kHalf), 0.4f);
  const float big = 20;
  add_quad(
      scene,
      add_material(scene, glass(float(kIor))),
      {{{1, -big, -big}, {1, big, -big}, {1, big, big}, {1, -big, big}}}
  );
  add_horizontal(scene, add_material(scene, diffuse(0)), 0.75f, 0.36f, 0.2f);
  const auto r = look(scene, {-1, 0, 0.3}, {0, 0, 0}, settings(16384, 2));
  CAPTURE(r.error);
  CHECK(r.error < 0.05 * r.mean);
  CHECK(r.mean == Approx(kAlbedo / kPi * irradiance).margin(4 * r.error));
}

TEST_CASE("A pane between two radiances shows R of one and (1 - R) tint of the other, at any angle"
) {
  constexpr float kTint = 0.8f, kIor = 1.52f;
  TraceScene scene;
  scene.environment = {2, 2, 2};
  add_horizontal(scene, add_material(scene, glass(kIor, {kTint, kTint, kTint})), 0, 50);
  add_horizontal(scene, add_material(scene, emitter(7)), -0.5f, 200);
  const PathTracer tracer(scene);
  for (const double angle_deg : {0.0, 20.0, 45.0, 60.0, 75.0, 85.0}) {
    const double a = angle_deg * kPi / 180, reflectance = slab(std::cos(a), kIor);
    const Camera camera = narrow_camera({std::sin(a), 0, std::cos(a)}, {0, 0, 0});
    const PathTracerOutput out = tracer.render(camera, settings(4));
    CAPTURE(angle_deg);
    CHECK(double(out.maps["reflected"].at(0, 0)) == Approx(reflectance * 2).epsilon(2e-4));
    CHECK(
        double(out.maps["transmitted"].at(0, 0)) ==
        Approx((1 - reflectance) * double(kTint) * 7).epsilon(2e-4)
    );
  }
}

TEST_CASE("Two parallel panes show the sum of all reflections between them") {
  constexpr double kIor = 1.9, kFront = 2, kBack = 7, kCosine = 0.5;
  TraceScene scene;
  scene.environment = {float(kFront), float(kFront), float(kFront)};
  const int pane = add_material(scene, glass(float(kIor)));
  add_horizontal(scene, pane, 0, 300);
  add_horizontal(scene, pane, -0.1f, 300);
  add_horizontal(scene, add_material(scene, emitter(float(kBack))), -0.5f, 300);
  const double r = slab(kCosine, kIor), t = 1 - r;
  const double through = t * t / (1 - r * r), back = t * t * r / (1 - r * r);
  const Camera camera = narrow_camera({std::sqrt(0.75), 0, 0.5}, {0, 0, 0}, 4);
  const PathTracer tracer(scene);
  double transmitted = 0;
  constexpr int kSeeds = 16;
  for (int i = 0; i < kSeeds; ++i) {
    auto s = settings(1024);
    s.seed = static_cast<std::uint64_t>(i);
    const PathTracerOutput out = tracer.render(camera, s);
    CHECK(double(out.maps["reflected"].at(0, 0)) == Approx(r * kFront).epsilon(1e-3));
    transmitted += mean_of(out.maps["transmitted"]) / kSeeds;
  }
  // One sample's spread is below |kBack - kFront|; 16 x 16 x 1024 samples.
  const double bound = 4 * (kBack - kFront) / std::sqrt(kSeeds * 16 * 1024.0);
  CHECK(transmitted == Approx(through * kBack + back * kFront).margin(bound));
}

TEST_CASE("The mean does not depend on the number of samples") {
  const TraceScene scene = glass_box_room();
  const PathTracer tracer(scene);
  const Camera camera = room_camera({32, 18});
  const MeanAndError many = mean_over_seeds(tracer, camera, settings(64), 8);
  for (const int spp : {1, 4}) {
    const MeanAndError few = mean_over_seeds(tracer, camera, settings(spp), 512 / spp);
    CAPTURE(spp, few.error, many.error);
    CHECK(few.error < 0.01 * few.mean);
    CHECK(few.mean == Approx(many.mean).margin(4 * std::hypot(few.error, many.error)));
  }
}

TEST_CASE("Next-event estimation and BSDF sampling alone agree in a room with a glass box") {
  const TraceScene scene = glass_box_room();
  const PathTracer tracer(scene);
  const Camera camera = room_camera({32, 18});
  const MeanAndError nee = mean_over_seeds(tracer, camera, settings(32), 16);
  const MeanAndError bsdf = mean_over_seeds(tracer, camera, settings(128, 200, false), 16);
  CAPTURE(nee.error, bsdf.error);
  CHECK(bsdf.error < 0.01 * bsdf.mean);
  CHECK(nee.mean == Approx(bsdf.mean).margin(4 * std::hypot(nee.error, bsdf.error)));
}

TEST_CASE("Depth is planar z and the normal faces the camera in OpenCV axes") {
  TraceScene scene;
  add_horizontal(scene, add_material(scene, diffuse(0.4f)), -2, 50);
  const Camera camera = look_at({0, 0, 1}, {0, 0, -2}, {0, 1, 0}, {16, 9}, 90);
  const PathTracerOutput out = PathTracer(scene).render(camera, settings(1));
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 16; ++x) {
      CHECK(out.maps["depth"].at(x, y) == Approx(3).epsilon(1e-5));
      CHECK(out.maps["normal"].at(x, y, 2) == Approx(-1).epsilon(1e-5));
      CHECK(out.maps["albedo"].at(x, y) == 0.4f);
    }
}

TEST_CASE("A slanted plane has the depth and normal of its equation") {
  TraceScene scene;
  add_horizontal(scene, add_material(scene, diffuse(0.4f)), 0, 100);
  const Camera camera = look_at({0, 0, 2}, {3, 1, 0}, {0, 0, 1}, {16, 9}, 60);
  const PathTracerOutput out = PathTracer(scene).render(camera, settings(1));
  const Vec3d up_in_cam = camera.rotation_cam_from_world * Vec3d{0, 0, 1};
  for (int y = 2; y < 9; ++y)
    for (int x = 0; x < 16; ++x) {
      const double depth = -2 / camera.ray_in_world(x + 0.5, y + 0.5).z;
      CHECK(double(out.maps["depth"].at(x, y)) == Approx(depth).epsilon(1e-4));
      for (int c = 0; c < 3; ++c)
        CHECK(double(out.maps["normal"].at(x, y, c)) == Approx(up_in_cam[c]).margin(1e-5));
    }
}

TEST_CASE("At glass the two components sum to the radiance to the bit, elsewhere they are zero") {
  const TraceScene scene = glass_box_room();
  const PathTracerOutput out = PathTracer(scene).render(room_camera({64, 36}), settings(8));
  int glass_pixels = 0;
  for (int i = 0; i < 64 * 36; ++i)
    for (int c = 0; c < 3; ++c) {
      const int x = i % 64, y = i / 64;
      const float t = out.maps["transmitted"].at(x, y, c), r = out.maps["reflected"].at(x, y, c);
      if (out.maps["glass"].at(x, y) != 0) {
        ++glass_pixels;
        CHECK(t + r == out.radiance.at(x, y, c));
        CHECK(out.maps["albedo"].at(x, y, c) == 0.0f);
        CHECK(out.maps["basecolor"].at(x, y, c) > 0.9f);
      } else {
        CHECK(t == 0.0f);
        CHECK(r == 0.0f);
      }
    }
  CHECK(glass_pixels > 300);
}

TEST_CASE("Depth and normal behind glass are those of the scene without panes") {
  TraceScene with = glass_box_room(), without = with;
  const auto is_pane = [&](const TraceMesh& mesh) {
    return with.materials[std::size_t(mesh.material)].kind == MaterialKind::kThinDielectric;
  };
  std::erase_if(without.meshes, is_pane);
  const Camera camera = room_camera({64, 36});
  const PathTracerOutput a = PathTracer(with).render(camera, settings(1));
  const PathTracerOutput b = PathTracer(without).render(camera, settings(1));
  CHECK(same_bytes(a.maps["behind_depth"], b.maps["depth"]));
  CHECK(same_bytes(a.maps["behind_normal"], b.maps["normal"]));
  CHECK(!same_bytes(a.maps["depth"], b.maps["depth"]));
}

TEST_CASE("Any number of threads renders the same bytes, another seed or view does not") {
  // The carpet's 20,000 triangles make Embree build the BVH in parallel.
  TraceScene scene = glass_box_room();
  add_carpet(scene, 0, 100);
  const Camera camera = room_camera({48, 27});
  const auto render = [&](int threads, std::uint64_t seed, std::uint64_t view) {
    set_num_threads(threads);
    auto s = settings(4);
    s.seed = seed;
    s.view = view;
    const PathTracerOutput out = PathTracer(scene).render(camera, s);
    set_num_threads(0);
    return out;
  };
  const PathTracerOutput one = render(1, 5, 2), two = render(2, 5, 2);
  CHECK(same_bytes(one.radiance, two.radiance));
  CHECK(same_bytes(one.maps["transmitted"], two.maps["transmitted"]));
  CHECK(same_bytes(one.maps["reflected"], two.maps["reflected"]));
  CHECK(same_bytes(one.maps["depth"], two.maps["depth"]));
  CHECK(same_bytes(one.maps["normal"], two.maps["normal"]));
  CHECK(!same_bytes(one.radiance, render(2, 6, 2).radiance));
  CHECK(!same_bytes(one.radiance, render(2, 5, 3).radiance));
}

TEST_CASE("Textures are bilinear between texel centres and repeat") {
  TraceScene scene;
  Image texture(2, 1, 3);
  for (int c = 0; c < 3; ++c) texture.at(1, 0, c) = 0.8f;
  scene.textures.push_back(texture);
  Material material = diffuse(1);
  material.texture = 0;
  add_horizontal(scene, add_material(scene, material), 0, 1);
  const PathTracer tracer(scene);
  const auto albedo_at = [&](float u) {  // the quad spans u in [0, 1] over x in [-1, 1]
    return tracer.first_hit({2 * u - 1, 0.1f, 1}, {0, 0, -1}, false).albedo.x;
  };
  CHECK(albedo_at(0.25f) == Approx(0).margin(1e-5));
  CHECK(albedo_at(0.75f) == Approx(0.8));
  CHECK(albedo_at(0.5f) == Approx(0.4));
  CHECK(albedo_at(0.375f) == Approx(0.2));
  CHECK(
      albedo_at(0.001f) == Approx(0.4 - 0.8 * 0.002).epsilon(1e-3)
  );  // blends with the last texel
}

TEST_CASE("First hits and visibility tell glass from opaque") {
  const TraceScene scene = glass_box_room();
  const PathTracer tracer(scene);
  const Vec3f eye{0, -2, 1}, ahead{0, 2, 0};
  const auto pane = tracer.first_hit(eye, ahead, false), wall = tracer.first_hit(eye, ahead, true);
  REQUIRE(pane.hit);
  CHECK(pane.glass);
  CHECK(pane.t == Approx(0.7));  // 1.4 m at 2 m a unit
  CHECK(pane.normal.y == Approx(-1));
  CHECK(scene.meshes[std::size_t(pane.mesh)].material == 2);
  REQUIRE(wall.hit);
  CHECK(!wall.glass);
  CHECK(wall.position.y == Approx(2.5));
  CHECK(!tracer.occluded(eye, {0, 2.49f, 1}));          // through two panes
  CHECK(tracer.occluded(eye, {0, 2.6f, 1}));            // behind the wall
  CHECK(tracer.occluded({0, -2, 0.1f}, {0, 2, 0.1f}));  // the table
  CHECK(!tracer.first_hit({0, 0, 5}, {0, 0, 1}, false).hit);
}

TEST_CASE("A scene that cannot be rendered is refused by name") {
  TraceScene scene = glass_box_room();
  scene.meshes[3].material = 17;
  CHECK_THAT(
      message_of([&] { PathTracer tracer(scene); }),
      Catch::Contains("quad3") && Catch::Contains("17")
  );
  scene = glass_box_room();
  scene.meshes[2].faces[1][0] = 4;
  CHECK_THAT(
      message_of([&] { PathTracer tracer(scene); }),
      Catch::Contains("quad2") && Catch::Contains("face 1")
  );
  scene = glass_box_room();
  scene.meshes[0].vertices[0].x = NAN;
  CHECK_THAT(message_of([&] { PathTracer tracer(scene); }), Catch::Contains("vertex 0"));
  scene = glass_box_room();
  scene.materials[0].albedo.x = 1.5f;
  CHECK_THAT(message_of([&] { PathTracer tracer(scene); }), Catch::Contains("albedo"));
  scene = glass_box_room();
  scene.materials[0].texture = 1;
  CHECK_THAT(message_of([&] { PathTracer tracer(scene); }), Catch::Contains("texture 1"));
  scene = glass_box_room();
  const PathTracer tracer(scene);
  CHECK_THROWS_AS(tracer.render(room_camera({8, 8}), settings(0)), Error);
}
