// SPDX-License-Identifier: MIT
// Every layer along a ray, and radiance by what its path did at the first two panes or mirrors:
// against closed forms and an intersection of its own.
#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "datasets/glassroom/check_panes.h"
#include "datasets/glassroom/noise_floor.h"
#include "datasets/glassroom/path_tracer.h"
#include "glint/core/error.h"
#include "tests/datasets/glassroom/trace_scenes.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr std::array<MapId, 6> kPaths{
    "path_t", "path_tt", "path_r", "path_tr", "path_rt", "path_rest"};

PathTracerSettings with_layers(int spp) { return {.spp = spp, .layers = true}; }

Material mirror(Vec3f albedo) {
  return {.name = "mirror", .kind = MaterialKind::kMirror, .albedo = albedo};
}

double slab(double cosine, double ior) {
  return static_cast<double>(thin_slab_reflectance(float(cosine), float(ior)));
}

// Of a narrow view: means over all its pixels and samples, of one channel.
struct PathMeans {
  double t = 0, tt = 0, r = 0, tr = 0, rt = 0, rest = 0;
};
PathMeans paths_along(const TraceScene& scene, Vec3d eye, Vec3d target, int spp) {
  const PathTracerOutput out =
      PathTracer(scene).render(narrow_camera(eye, target, 8), with_layers(spp));
  const auto mean = [&](MapId id) { return mean_of(out.maps[id]); };
  return {
      mean("path_t"),
      mean("path_tt"),
      mean("path_r"),
      mean("path_tr"),
      mean("path_rt"),
      mean("path_rest")};
}

// A rectangle with axis-aligned sides at `at` along `axis`, over `low` to `high` of the others.
struct Rectangle {
  int axis;
  double at;
  Vec3d low, high;
  bool glass;
};

std::vector<Rectangle> sides_of(Vec3d low, Vec3d high, bool glass) {
  std::vector<Rectangle> sides;
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {low[axis], high[axis]}) sides.push_back({axis, at, low, high, glass});
  return sides;
}

// Nearest first, up to the first that is not glass.
std::vector<std::pair<double, const Rectangle*>> hits(
    const std::vector<Rectangle>& all, Vec3d eye, Vec3d ray
) {
  std::vector<std::pair<double, const Rectangle*>> met;
  for (const Rectangle& side : all) {
    const double t = (side.at - eye[side.axis]) / ray[side.axis];
    if (!(t > 0)) continue;
    const Vec3d p = eye + t * ray;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis)
      inside =
          inside && (axis == side.axis || (p[axis] > side.low[axis] && p[axis] < side.high[axis]));
    if (inside) met.emplace_back(t, &side);
  }
  std::sort(met.begin(), met.end());
  const auto opaque =
      std::find_if(met.begin(), met.end(), [](const auto& hit) { return !hit.second->glass; });
  if (opaque != met.end()) met.erase(opaque + 1, met.end());
  return met;
}

struct LayerIds {
  MapId depth, normal, glass, mirror;
};
constexpr std::array<LayerIds, 4> kLayers{
    {{"depth", "normal", "glass", "layer_1_mirror"},
     {"layer_2_depth", "layer_2_normal", "layer_2_glass", "layer_2_mirror"},
     {"layer_3_depth", "layer_3_normal", "layer_3_glass", "layer_3_mirror"},
     {"layer_4_depth", "layer_4_normal", "layer_4_glass", "layer_4_mirror"}}};

}  // namespace

TEST_CASE("The layers of nested glass boxes are those of an intersection of their planes") {
  const Vec3d big{0.6, 0.5, 0.7}, small{0.25, 0.2, 0.3}, core{0.1, 0.07, 0.12};
  std::vector<Rectangle> all = sides_of({-2, -2, -1}, {2, 2, 1.5}, false);
  TraceScene scene;
  const int wall = add_material(scene, diffuse(0.5f)), pane = add_material(scene, glass(1.5f));
  add_box(scene, wall, {-2, -2, -1}, {2, 2, 1.5f});
  for (const Vec3d half : {big, small, core}) {
    const bool is_glass = half.x > core.x;
    const std::vector<Rectangle> sides = sides_of(-half, half, is_glass);
    all.insert(all.end(), sides.begin(), sides.end());
    add_box(scene, is_glass ? pane : wall, cast<float>(-half), cast<float>(half));
  }
  const Camera camera = look_at({1.3, -1.1, 0.45}, {0, 0, 0}, {0, 0, 1}, {48, 36}, 60);
  const MapSet maps = PathTracer(scene).render(camera, with_layers(1)).maps;
  std::array<int, 6> seen{};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vec3d ray = camera.ray_in_world(x + 0.5, y + 0.5);
      const auto expected = hits(all, camera.center(), ray);
      ++seen[std::min<std::size_t>(expected.size(), 5)];
      for (std::size_t k = 0; k < 4; ++k) {
        CAPTURE(x, y, k);
        const float depth = maps[kLayers[k].depth].at(x, y);
        CHECK(maps[kLayers[k].mirror].at(x, y) == 0);
        if (k >= expected.size()) {
          CHECK(depth == 0);
          CHECK(maps[kLayers[k].glass].at(x, y) == 0);
          CHECK(maps[kLayers[k].normal].at(x, y, 2) == 0);
          continue;
        }
        const auto& [t, side] = expected[k];
        Vec3d normal{};
        normal[side->axis] = ray[side->axis] > 0 ? -1 : 1;
        normal = camera.rotation_cam_from_world * normal;
        CHECK(double(depth) == Approx(camera.to_cam(camera.center() + t * ray).z).epsilon(1e-5));
        CHECK(maps[kLayers[k].glass].at(x, y) == (side->glass ? 1.0f : 0.0f));
        for (int c = 0; c < 3; ++c)
          CHECK(double(maps[kLayers[k].normal].at(x, y, c)) == Approx(normal[c]).margin(1e-5));
      }
    }
  for (const std::size_t count : {1u, 3u, 5u}) CHECK(seen[count] > 100);
}

TEST_CASE("Behind a mirror stands the mirror image, with the mirror's share of its radiance") {
  const Vec3f albedo{0.9f, 0.8f, 0.7f};
  TraceScene scene;
  add_horizontal(scene, add_material(scene, mirror(albedo)), 0, 20);
  add_horizontal(scene, add_material(scene, emitter(3)), 2, 20);
  const Camera camera = look_at({0, 0, 1}, {1.5, 0.4, 0}, {0, 0, 1}, {16, 9}, 40);
  const PathTracerOutput out = PathTracer(scene).render(camera, with_layers(2));
  const Vec3d up = camera.rotation_cam_from_world * Vec3d{0, 0, 1};
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 16; ++x) {
      const Vec3d ray = camera.ray_in_world(x + 0.5, y + 0.5);
      CHECK(out.maps["layer_1_mirror"].at(x, y) == 1);
      CHECK(out.maps["glass"].at(x, y) == 0);
      CHECK(out.maps["layer_2_mirror"].at(x, y) == 0);
      CHECK(double(out.maps["depth"].at(x, y)) == Approx(-1 / ray.z).epsilon(1e-5));
      CHECK(out.maps["behind_depth"].at(x, y) == out.maps["depth"].at(x, y));
      CHECK(double(out.maps["layer_2_depth"].at(x, y)) == Approx(-3 / ray.z).epsilon(1e-5));
      CHECK(out.maps["layer_3_depth"].at(x, y) == 0);
      for (int c = 0; c < 3; ++c) {
        CHECK(double(out.maps["layer_2_normal"].at(x, y, c)) == Approx(up[c]).margin(1e-5));
        CHECK(out.radiance.at(x, y, c) == Approx(3 * albedo[c]).epsilon(1e-5));
        CHECK(out.maps["path_r"].at(x, y, c) == out.radiance.at(x, y, c));
        CHECK(out.maps["basecolor"].at(x, y, c) == albedo[c]);
        for (const MapId none : {MapId("albedo"), MapId("reflected"), MapId("path_rest")})
          CHECK(out.maps[none].at(x, y, c) == 0);
      }
    }
}

TEST_CASE("A mirror in a mirror ends at the fourth layer") {
  TraceScene scene;
  const int silver = add_material(scene, mirror({1, 1, 1}));
  add_horizontal(scene, silver, 0, 100);
  add_horizontal(scene, silver, 3, 100);
  const Camera camera = narrow_camera({0, 0, 1}, {0.3, 0.2, 0});
  const MapSet maps = PathTracer(scene).render(camera, with_layers(1)).maps;
  const double slope = camera.ray_in_world(0.5, 0.5).z;
  const double faces = (camera.rotation_cam_from_world * Vec3d{0, 0, 1}).z;
  for (std::size_t k = 0; k < 4; ++k) {
    CAPTURE(k);
    const double expected = -(1 + 3 * static_cast<double>(k)) / slope;
    CHECK(double(maps[kLayers[k].depth].at(0, 0)) == Approx(expected).epsilon(1e-5));
    CHECK(maps[kLayers[k].mirror].at(0, 0) == 1);
    CHECK(double(maps[kLayers[k].normal].at(0, 0, 2)) == Approx(faces).margin(1e-5));
  }
}

TEST_CASE("Through two panes the parts are the products of what each does") {
  constexpr double kIor = 1.9, kFront = 2, kBack = 7, kCosine = 0.5, kTint = 0.9, kTint2 = 0.6;
  TraceScene scene;
  scene.environment = {float(kFront), float(kFront), float(kFront)};
  const auto grey = [](double v) { return Vec3f{float(v), float(v), float(v)}; };
  add_horizontal(scene, add_material(scene, glass(float(kIor), grey(kTint))), 0, 300);
  add_horizontal(scene, add_material(scene, glass(float(kIor), grey(kTint2))), -0.1f, 300);
  add_horizontal(scene, add_material(scene, emitter(float(kBack))), -0.5f, 300);
  const double r = slab(kCosine, kIor), t1 = (1 - r) * kTint, t2 = (1 - r) * kTint2;
  const double up = (t1 * kFront + r * t2 * kBack) / (1 - r * r);  // towards the first, from within
  const PathMeans mean = paths_along(scene, {std::sqrt(0.75), 0, 0.5}, {0, 0, 0}, 4096);
  // A sample is all or nothing: below kBack each, 64 x 4096 of them.
  constexpr double kBound = 4 * kBack / (8 * 64.0);
  CHECK(mean.r == Approx(r * kFront).epsilon(1e-4));
  CHECK(mean.tt == Approx(t1 * t2 * kBack).margin(kBound));
  CHECK(mean.tr == Approx(t1 * r * up).margin(kBound));
  for (const double none : {mean.t, mean.rt, mean.rest}) CHECK(none == 0);
}

TEST_CASE("Between a mirror and a pane the parts are the products of what each does") {
  constexpr double kIor = 1.9, kLight = 2, kCosine = 0.5, kTint = 0.9, a = 0.8;
  TraceScene scene;
  scene.environment = {float(kLight), float(kLight), float(kLight)};
  add_horizontal(scene, add_material(scene, mirror({float(a), float(a), float(a)})), 0, 300);
  const Vec3f tint{float(kTint), float(kTint), float(kTint)};
  add_horizontal(scene, add_material(scene, glass(float(kIor), tint)), 1, 300);
  const double r = slab(kCosine, kIor), t = (1 - r) * kTint;
  const double up = t * kLight / (1 - r * a);  // towards the pane, from within
  constexpr double kBound = 4 * kLight / (8 * 64.0);
  const Vec3d away{std::sqrt(0.75), 0, 0.5};

  const PathMeans below = paths_along(scene, away, {0, 0, 0}, 4096);
  CHECK(below.rt == Approx(a * t * kLight).margin(kBound));
  CHECK(below.rest == Approx(a * r * a * up).margin(kBound));
  for (const double none : {below.t, below.tt, below.r, below.tr}) CHECK(none == 0);

  const PathMeans above = paths_along(scene, Vec3d{0, 0, 1} + away, {0, 0, 1}, 4096);
  CHECK(above.r == Approx(r * kLight).epsilon(1e-4));
  CHECK(above.tr == Approx(t * a * up).margin(kBound));
  for (const double none : {above.t, above.tt, above.rt, above.rest}) CHECK(none == 0);
}

TEST_CASE("Through one pane onto something rough is T, whatever light does after") {
  TraceScene scene;
  add_box(scene, add_material(scene, emitter(1, 0.5f)), {-3, -3, -3}, {3, 3, 3});
  const int silver = add_material(scene, mirror({1, 1, 1}));
  add_quad(scene, silver, {{{-1, -2, -2}, {-1, 2, -2}, {-1, 2, 2}, {-1, -2, 2}}});
  add_horizontal(scene, add_material(scene, glass(1.5f)), 0, 0.9f, 1);
  const PathMeans mean = paths_along(scene, {1, 0, 1}, {1, 0, 0}, 64);
  const double r = slab(1, 1.5);
  CHECK(mean.t == Approx((1 - r) * 2).epsilon(0.02));
  CHECK(mean.r == Approx(r * 2).epsilon(0.02));
  for (const double none : {mean.tt, mean.tr, mean.rt, mean.rest}) CHECK(none == 0);
}

TEST_CASE("The parts of all paths add up, and asking for them changes nothing else") {
  TraceScene scene = glass_box_room();
  const int silver = add_material(scene, mirror({0.9f, 0.95f, 0.9f}));
  add_quad(
      scene, silver, {{{-2.9f, -2, 0.5f}, {-2.9f, 2, 0.5f}, {-2.9f, 2, 2.2f}, {-2.9f, -2, 2.2f}}}
  );
  const PathTracer tracer(scene);
  const Camera camera = room_camera({64, 36});
  const PathTracerOutput out = tracer.render(camera, with_layers(8));
  const PathTracerOutput plain = tracer.render(camera, {.spp = 8});
  CHECK(std::ranges::equal(out.radiance.values(), plain.radiance.values()));
  plain.maps.for_each([&](const MapRow& row, const Image& map) {
    CAPTURE(row.id);
    CHECK(std::ranges::equal(out.maps[row].values(), map.values()));
  });
  CHECK_FALSE(plain.maps.has("path_t"));
  CHECK(plain.halves[0].empty());
  int glass_pixels = 0, mirror_pixels = 0;
  for (int i = 0; i < 64 * 36 * 3; ++i) {
    const int x = i / 3 % 64, y = i / 3 / 64, c = i % 3;
    const bool glass = out.maps["glass"].at(x, y) != 0;
    const bool mirrors = out.maps["layer_1_mirror"].at(x, y) != 0;
    glass_pixels += glass, mirror_pixels += mirrors;
    std::array<float, 6> part{};
    for (std::size_t k = 0; k < 6; ++k) part[k] = out.maps[kPaths[k]].at(x, y, c);
    const float t = part[0] + part[1] + part[3], r = part[2] + part[4] + part[5];
    const float radiance = out.radiance.at(x, y, c);
    CAPTURE(x, y, c);
    CHECK(t + r == Approx(glass || mirrors ? radiance : 0).epsilon(1e-5).margin(1e-7));
    CHECK(out.maps["transmitted"].at(x, y, c) == Approx(glass ? t : 0).epsilon(1e-5).margin(1e-7));
    CHECK(out.maps["reflected"].at(x, y, c) == Approx(glass ? r : 0).epsilon(1e-5).margin(1e-7));
    const float mean = 0.5f * (out.halves[0]["rgb"].at(x, y, c) + out.halves[1]["rgb"].at(x, y, c));
    CHECK(mean == Approx(radiance).epsilon(1e-5));
  }
  CHECK(glass_pixels > 900);
  CHECK(mirror_pixels > 300);
}

TEST_CASE("Next-event estimation and BSDF sampling alone agree in a room with a mirror") {
  TraceScene scene = glass_box_room();
  add_quad(
      scene,
      add_material(scene, mirror({0.9f, 0.9f, 0.9f})),
      {{{-2.9f, -2, 0.2f}, {-2.9f, 2, 0.2f}, {-2.9f, 2, 2.6f}, {-2.9f, -2, 2.6f}}}
  );
  const PathTracer tracer(scene);
  const Camera camera = room_camera({24, 14});
  const MeanAndError nee = mean_over_seeds(tracer, camera, {.spp = 32}, 16);
  const MeanAndError bsdf =
      mean_over_seeds(tracer, camera, {.spp = 128, .next_event_estimation = false}, 16);
  CAPTURE(nee.error, bsdf.error);
  CHECK(bsdf.error < 0.01 * bsdf.mean);
  CHECK(nee.mean == Approx(bsdf.mean).margin(4 * std::hypot(nee.error, bsdf.error)));
}

TEST_CASE("The noise floor is that of the mean of both halves") {
  const TraceScene scene = glass_box_room();
  const PathTracer tracer(scene);
  const Camera camera = room_camera({32, 18});
  const Image truth = tracer.render(camera, {.spp = 2048, .seed = 9}).radiance;
  const PathTracerOutput out = tracer.render(camera, with_layers(16));
  NoiseFloor floor;
  CHECK(floor.json().is_null());
  floor.add(out, 0.5f);
  floor.add(tracer.render(camera, with_layers(1)), 0.5f);  // has no halves
  double sum = 0;
  for (std::size_t i = 0; i < truth.values().size(); ++i) {
    const double off = 0.5 * static_cast<double>(out.radiance.values()[i] - truth.values()[i]);
    sum += off * off;
  }
  const double off = std::sqrt(sum / static_cast<double>(truth.values().size()));
  const Json json = floor.json();
  CHECK(json["views"] == 1);
  CHECK(json["rgb"]["standard_error"].get<double>() == Approx(off).epsilon(0.3));
  CHECK(json["rgb"]["psnr"].get<double>() > 20);
  CHECK(json["path_r"]["standard_error"].get<double>() > 0);
  CHECK_FALSE(json.contains("depth"));
}

TEST_CASE("Panes that touch or cross are refused by name") {
  TraceScene scene;
  const int pane = add_material(scene, glass(1.5f));
  add_horizontal(scene, pane, 0, 1);
  add_horizontal(scene, pane, 0.01f, 1);
  add_quad(scene, pane, {{{1.1f, -1, -1}, {1.1f, 1, -1}, {1.1f, 1, 1}, {1.1f, -1, 1}}});
  add_horizontal(scene, add_material(scene, diffuse(0.5f)), 0, 1);  // opaque: of no concern
  check_panes(scene);
  TraceScene near = scene;
  for (Vec3f& vertex : near.meshes[1].vertices) vertex.z = 0.0005f;
  CHECK_THROWS_WITH(check_panes(near), Catch::Contains("quad0") && Catch::Contains("quad1"));
  for (Vec3f& vertex : scene.meshes[2].vertices) vertex.x = 0.5f;
  CHECK_THROWS_WITH(check_panes(scene), Catch::Contains("quad2") && Catch::Contains("0 mm apart"));
}

TEST_CASE("A mirror that glows is refused") {
  TraceScene scene;
  Material glowing = mirror({1, 1, 1});
  glowing.emission = {1, 1, 1};
  add_horizontal(scene, add_material(scene, glowing), 0, 1);
  CHECK_THROWS_WITH(PathTracer(scene), Catch::Contains("a mirror cannot emit"));
}
