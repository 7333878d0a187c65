// SPDX-License-Identifier: MIT
// Panes of glass whose plane is known: what they mirror is what the camera behind them sees, at the
// share k_s of the picture, with gradients to the sets that are seen there.
#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/rng.h"
#include "glint/glint_model.h"
#include "glint/train/find_mirrors.h"
#include "tests/support/check_array_gradient.h"
#include "tests/support/random_values.h"
#include "tests/support/same_bytes.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{20, 12};

Camera camera() { return look_at({0, 0, 0}, {0.1, 0, 3}, {0, -1, 0}, kSize, 70); }

// The middle of the view, 2 m away, a little turned.
MirrorPlane pane() {
  MirrorPlane plane;
  plane.center = {0.1, 0, 2};
  plane.normal = normalize(Vec3d{0.05, -0.03, -1});
  plane.across = normalize(cross(plane.normal, Vec3d{0, 1, 0}));
  plane.half_width = 0.8, plane.half_height = 0.5;
  plane.pane = true;
  return plane;
}

void add_wall(SurfelCloud& cloud, double depth, float t, float s, Rng& rng) {
  const double half = 1.2 * std::abs(depth), step = half / 6;
  for (double x = -half; x <= half; x += step)
    for (double y = -half; y <= half; y += step) {
      const std::size_t i = cloud.size();
      cloud.resize(i + 1);
      put3(cloud.means.data(), i, cast<float>(Vec3d{x, y, depth}));
      for (std::size_t k = 0; k < 3; ++k) cloud.sh_dc[3 * i + k] = rng.uniform(-1.2f, 1.2f);
      cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] =
          static_cast<float>(std::log(0.8 * step));
      cloud.rotations[4 * i] = 1;
      cloud.opacity_logits[i] = 2;
      if (cloud.num_extra() == 0) continue;
      cloud.extra_logits[2 * i] = std::log(t / (1 - t));
      cloud.extra_logits[2 * i + 1] = std::log(s / (1 - s));
    }
}

// A pane, a room behind the camera that the interface set knows, another behind the pane.
struct Fixture {
  GlintModel model;
  GlintConfig config;
  GlintPhase phase;
  Image weights;

  explicit Fixture(float specular = 0.2f) {
    config.detach_transparency = false;
    config.mirror.share_below = 0;
    phase.interface_degree = phase.transmission_degree = phase.reflection_degree = 0;
    Rng rng(1);
    SurfelCloud interface, transmission, reflection;
    interface.extra_names = {kTransparency, kSpecular};
    add_wall(interface, 2, 0.9f, specular, rng);
    add_wall(interface, -2, 0.05f, 0.05f, rng);
    add_wall(transmission, 4, 0, 0, rng);
    add_wall(reflection, -1, 0, 0, rng);
    model.interface = TrainableSet(interface, {});
    model.transmission = TrainableSet(transmission, {});
    model.reflection = TrainableSet(reflection, {});
    weights = random_map(rng, kSize, 3, -1, 1);
  }
  const Image& picture() { return model.forward(camera(), config, phase); }
  double loss() {
    const Image& image = picture();
    double sum = 0;
    for (std::size_t i = 0; i < image.values().size(); ++i)
      sum += static_cast<double>(weights.values()[i]) * static_cast<double>(image.values()[i]);
    return sum;
  }
  void backward() {
    picture();
    RasterOutputGradient dL_dinterface;
    clear_gradient(kSize, model.interface_output().features.channels(), dL_dinterface);
    model.backward(weights, {}, true, dL_dinterface);
  }
};

}  // namespace

TEST_CASE("A pane mirrors what the camera behind it sees, at k_s of the picture") {
  Fixture f;
  const Image without = f.picture();
  const Image traced = f.model.layers().reflection;
  f.model.set_planes({pane()});
  REQUIRE(f.model.panes.planes.size() == 1);
  CHECK(f.model.mirrors.planes.empty());
  const Image with = f.picture();
  const Image mirrored = f.model.layers().reflection;
  const Image depth = f.model.buffer().depth, share = f.model.buffer().specularity;

  PlaneMirrors alone;
  alone.planes = {pane()};
  const Image seen = alone.put(
      {f.model.interface, f.model.transmission},
      f.model.mirrors_call(camera(), f.config, f.phase),
      depth,
      traced
  );
  CHECK(same_bytes(mirrored, seen));
  int changed = 0;
  for (std::size_t i = 0; i < kSize.num_pixels(); ++i) {
    const bool is_seen = alone.seen()->data()[i] > 0;
    const Vec3f more = get3(with.data(), i) - get3(without.data(), i);
    const Vec3f other = get3(mirrored.data(), i) - get3(traced.data(), i);
    CHECK(length(more - share.data()[i] * other) < 1e-5f);
    if (!is_seen) CHECK(length(other) == 0);
    changed += length(more) > 1e-3f ? 1 : 0;
  }
  CHECK(changed > 20);
  f.phase.reflection = false;
  const Image dull = f.picture();
  f.model.set_planes({});
  CHECK(same_bytes(f.picture(), dull));
}

TEST_CASE("Maps of the first surface have a pane's plane where it is seen") {
  Fixture f;
  f.phase.transmission = f.phase.reflection = true;
  const MapSet without = f.model.render(camera(), f.config, f.phase);
  MirrorPlane plane = pane();
  plane.center.z -= 0.04;  // where its surfels are not
  f.model.set_planes({plane});
  const MapSet with = f.model.render(camera(), f.config, f.phase);
  const Vec3d center = camera().to_cam(plane.center);
  const Vec3d normal = camera().rotation_cam_from_world * plane.normal;
  int num_seen = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const Vec3d ray = camera().ray_in_cam(x + 0.5, y + 0.5);
      const double z = dot(normal, center) / dot(normal, ray);
      const bool is_seen = plane.holds(camera().to_world(z * ray));
      const auto depth = static_cast<double>(with["depth"].at(x, y));
      const Vec3d n = cast<double>(get3(with["normal"].pixel(x, y), 0));
      num_seen += is_seen ? 1 : 0;
      CHECK(depth == Approx(is_seen ? z : static_cast<double>(without["depth"].at(x, y))));
      if (is_seen) CHECK(length(n - normal) < 1e-5);
    }
  CHECK(num_seen > 20);
  CHECK(num_seen < 200);
  CHECK(same_bytes(with["transparency"], without["transparency"]));
}

TEST_CASE("A pane whose surfels are cut away is in no map of the first surface") {
  Fixture f;
  f.phase.transmission = f.phase.reflection = true;
  SurfelCloud& surfels = f.model.interface.cloud();
  SECTION("nothing is left") {
    for (std::size_t i = 0; i < surfels.size(); ++i) surfels.opacity_logits[i] = -1e3f;
  }
  SECTION("what stood behind is left") {
    for (std::size_t i = 0; i < surfels.size(); ++i) surfels.means[3 * i + 2] *= 1.7f;
  }
  MapSet without = f.model.render(camera(), f.config, f.phase);
  f.model.set_planes({pane()});
  MapSet with = f.model.render(camera(), f.config, f.phase);
  CHECK(same_bytes(with["depth"], without["depth"]));
  CHECK(same_bytes(with["normal"], without["normal"]));
}

TEST_CASE("What is behind the pane may be traced, to the same picture") {
  Fixture f;
  const Image rasterized = f.picture();
  f.config.transmission = "trace";
  const Image traced = f.picture();
  CHECK_FALSE(same_bytes(traced, rasterized));
  for (std::size_t i = 0; i < traced.values().size(); ++i)
    CHECK(traced.values()[i] == Approx(rasterized.values()[i]).margin(2e-3));
  f.backward();
  const auto check = [&](TrainableSet& set, FloatArray SurfelCloud::*array, const char* name) {
    check_array_gradient([&] { return f.loss(); }, set, array, name);
  };
  check(f.model.transmission, &SurfelCloud::sh_dc, "colours behind");
  check(f.model.interface, &SurfelCloud::extra_logits, "t and s of the interface");
}

TEST_CASE("Gradients reach the sets through what a pane mirrors") {
  Fixture f;
  f.model.set_planes({pane()});
  f.backward();
  const auto check = [&](TrainableSet& set, FloatArray SurfelCloud::*array, const char* name) {
    check_array_gradient([&] { return f.loss(); }, set, array, name);
  };
  check(f.model.interface, &SurfelCloud::sh_dc, "colours of the interface");
  check(f.model.interface, &SurfelCloud::extra_logits, "t and s of the interface");
  check(f.model.transmission, &SurfelCloud::sh_dc, "colours behind");
  check(f.model.reflection, &SurfelCloud::sh_dc, "colours of the reflection set");
}

TEST_CASE(
    "The back of a pane mirrors Fresnel's share of what the other side sees, through the front"
) {
  Fixture f;
  MirrorPlane front = pane().turned();
  front.center = {0.1, 0, 3};
  CHECK(dot(front.normal, Vec3d{0, 0, -1}) < 0);
  SurfelCloud inside = f.model.transmission.cloud();
  const std::size_t num_behind = inside.sh_dc.size();  // the rest is seen by the far pane only
  Rng rng(2);
  add_wall(inside, -2.5, 0, 0, rng);
  f.model.transmission = TrainableSet(inside, {});
  const Image without = f.picture();
  const Image behind = f.model.layers().transmission;
  f.model.set_planes({front});
  const Image with = f.picture();
  const Image t = f.model.buffer().transparency, k = f.model.buffer().specularity;
  int changed = 0;
  for (std::size_t i = 0; i < kSize.num_pixels(); ++i) {
    const Vec3f other = get3(f.model.layers().transmission.data(), i) - get3(behind.data(), i);
    const Vec3f more = get3(with.data(), i) - get3(without.data(), i);
    CHECK(length(more - (1 - k.data()[i]) * t.data()[i] * other) < 1e-5f);
    CHECK(length(other) < 0.1f);  // a twentieth of a picture, where it is seen steeply
    changed += length(other) > 1e-4f ? 1 : 0;
  }
  CHECK(changed > 20);
  f.backward();  // a constant
  check_array_gradient(
      [&] { return f.loss(); }, f.model.transmission, &SurfelCloud::sh_dc, "behind", num_behind
  );
  const FloatArray& gradient = f.model.transmission.gradient().sh_dc;
  for (std::size_t i = num_behind; i < gradient.size(); ++i) CHECK(gradient[i] == 0);

  Fixture later;  // the pane is there no more
  later.model.set_planes({front});
  later.picture();
  later.model.set_planes({});
  later.backward();
  check_array_gradient(
      [&] { return later.loss(); }, later.model.transmission, &SurfelCloud::sh_dc, "without it"
  );
}

TEST_CASE("A picture without what panes mirror in it is what came through") {
  Fixture f;
  f.model.set_planes({pane()});
  const Image with = f.picture();
  const Image through = f.model.without_panes(with);
  const Image& t = f.model.buffer().transparency;
  int changed = 0;
  for (std::size_t i = 0; i < kSize.num_pixels(); ++i) {
    if (f.model.panes.seen()->data()[i] <= 0) {
      CHECK(length(get3(through.data(), i) - get3(with.data(), i)) == 0);
      continue;
    }
    const Vec3f expected = (1 - t.data()[i]) * get3(f.model.layers().interface.data(), i) +
                           t.data()[i] * get3(f.model.layers().transmission.data(), i);
    CHECK(length(get3(through.data(), i) - expected) < 1e-5f);
    ++changed;
  }
  CHECK(changed > 20);

  MirrorsCall call = f.model.mirrors_call(camera(), f.config, f.phase);
  call.f0 = kGlassF0;
  PlaneMirrors backs;  // two of them, one before the other
  backs.planes = {pane(), pane()};
  backs.planes[1].center.z += 0.1;
  const Image& behind = f.model.layers().transmission;
  const Image far_away(kSize.width, kSize.height, 1);
  Image both = backs.put({f.model.interface, f.model.transmission}, call, far_away, behind);
  CHECK_FALSE(same_bytes(both, behind));
  backs.take_out(both);
  for (std::size_t i = 0; i < both.values().size(); ++i)
    CHECK(both.values()[i] == Approx(behind.values()[i]).margin(1e-5));

  f.model.set_planes({});
  f.picture();
  CHECK(&f.model.without_panes(with) == &with);
}

namespace {

// Views of the pane, dark and flat to priors; the interface has it 4 cm farther away.
struct Photographed : Fixture {
  Scene scene;
  MirrorPlane plane = pane();

  Photographed() : Fixture(0.05f) {
    plane.normal = {0, 0, -1}, plane.across = {1, 0, 0}, plane.center = {0, 0, 1.96};
    model.set_planes({plane});
    scene.spatial_scale = 2;
    photograph();
  }
  void photograph() {
    scene.train.clear();
    for (int k = 0; k < 8; ++k) add_view({0.2 * k - 0.7, 0.05 * k - 0.2, 0.1 * (k % 3)});
  }
  void add_view(Vec3d eye) {
    View view;
    view.camera = look_at(eye, {0, 0, 2}, {0, -1, 0}, {60, 40}, 60);
    view.rgb = model.forward(view.camera, config, phase);
    view.priors["albedo"] = Image(60, 40, 3, 0.5f);
    view.priors["normal"] = Image(60, 40, 3);
    const Vec3f normal = cast<float>(view.camera.rotation_cam_from_world * plane.normal);
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 60; ++x) {
        put3(view.priors["normal"].pixel(x, y), 0, normal);
        const Vec3d ray = view.camera.ray_in_world(x + 0.5, y + 0.5);
        const Vec3d at = eye + ((plane.center.z - eye.z) / ray.z) * ray;
        if (std::abs(at.x) < plane.half_width && std::abs(at.y) < plane.half_height)
          put3(view.priors["albedo"].pixel(x, y), 0, Vec3f{0.01f, 0.01f, 0.01f});
      }
    scene.train.push_back(std::move(view));
  }
  std::vector<MirrorPlane> found() {
    return candidate_mirrors(
        scene,
        {model.interface, model.transmission},
        model.mirrors_call(camera(), config, phase),
        {.panes = true}
    );
  }
};

}  // namespace

TEST_CASE("A pane is placed where what it mirrors is what the photos have beside") {
  Photographed f;
  const auto planes = f.found();
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].pane);
  CHECK(planes[0].likeness > 0.9);
  CHECK(is_mirroring(planes[0], {}));
  CHECK(planes[0].center.z == Approx(1.96).margin(0.01));
  CHECK(planes[0].half_width * planes[0].half_height == Approx(0.8 * 0.5).epsilon(0.1));
}

TEST_CASE("A dark plane whose photos have noise alone beside what is seen through it is no pane") {
  Photographed f;
  f.model.set_planes({});
  for (float& opacity : f.model.reflection.cloud().opacity_logits) opacity = -20;
  f.photograph();
  Rng rng(9);
  for (View& view : f.scene.train)
    for (float& value : view.rgb.values()) value += rng.uniform(-0.05f, 0.05f);
  const auto planes = f.found();
  REQUIRE(planes.size() == 1);
  CHECK_FALSE(is_mirroring(planes[0], {}));
}
