// SPDX-License-Identifier: MIT
// Glass behind glass: the picture of several layers against independent renderers and the sum over
// layers, its gradient by central differences, and its special cases.
#include "glint/glint_layers.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/rng.h"
#include "glint/glint_model.h"
#include "glint/render/map_ops.h"
#include "tests/support/check_array_gradient.h"
#include "tests/support/random_values.h"
#include "tests/support/reference_render.h"
#include "tests/support/reference_trace.h"
#include "tests/support/same_bytes.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{18, 10};
constexpr double kGap = 0.05, kPaneGap = 0.4;

Camera camera() {
  Camera camera;
  camera.width = kSize.width, camera.height = kSize.height;
  camera.fx = camera.fy = 16;
  camera.cx = 9.3, camera.cy = 4.8;
  return camera;
}

double logit(double share) { return std::log(share / (1 - share)); }

// A wall of overlapping surfels across the view at a depth, from x = low to high at its height.
struct Wall {
  double depth, low, high;  // of the width that is seen there
  double transparency = 0.03, specular = 0.02;
};

void add_surfel(SurfelCloud& cloud, Vec3d mean, double scale, const Wall& wall, Rng& rng) {
  const std::size_t i = cloud.size();
  cloud.resize(i + 1);
  for (int c = 0; c < 3; ++c) {
    cloud.means[3 * i + static_cast<std::size_t>(c)] = static_cast<float>(mean[c]);
    cloud.sh_dc[3 * i + static_cast<std::size_t>(c)] = rng.uniform(-1.2f, 1.2f);
  }
  cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = static_cast<float>(std::log(scale));
  cloud.rotations[4 * i] = 1;  // facing, but for a little
  cloud.rotations[4 * i + 1] = rng.uniform(-0.04f, 0.04f);
  cloud.rotations[4 * i + 2] = rng.uniform(-0.04f, 0.04f);
  cloud.opacity_logits[i] = static_cast<float>(logit(0.9));
  if (cloud.num_extra() == 0) return;
  cloud.extra_logits[2 * i] = static_cast<float>(logit(wall.transparency));
  cloud.extra_logits[2 * i + 1] = static_cast<float>(logit(wall.specular));
}

SurfelCloud walls(const std::vector<Wall>& walls, bool glass, std::uint64_t seed) {
  Rng rng(seed);
  SurfelCloud cloud;
  if (glass) cloud.extra_names = {kTransparency, kSpecular};
  for (const Wall& wall : walls) {
    const double z = std::abs(wall.depth), half = 0.65 * z, step = 0.16 * z;
    for (double x = -half; x <= half; x += step)
      for (double y = -0.45 * z; y <= 0.45 * z; y += step)
        if (x >= (2 * wall.low - 1) * half && x <= (2 * wall.high - 1) * half)
          add_surfel(cloud, {x, y, wall.depth}, 0.8 * step, wall, rng);
  }
  return cloud;
}

// A pane before all; to the right a second one that the interface set knows, to the left one of the
// transmission set; a thing in front of the far pane, and what is behind all.
struct Fixture {
  GlintModel model;
  GlintConfig config;
  GlintPhase phase;
  Image weights;

  explicit Fixture(int layers, float first_transparency = 0.9f) {
    config.layers = layers;
    config.layer_gap = static_cast<float>(kGap);
    config.pane_gap = static_cast<float>(kPaneGap);
    config.detach_transparency = false;
    config.mirror.share_below = 0;
    config.mirror.transmittance = kMinTransmittance;
    config.mirror.hits = 256;
    phase.interface_degree = phase.transmission_degree = phase.reflection_degree = 0;
    phase.step = 1;
    model.interface = TrainableSet(
        walls({{2, 0, 1, first_transparency}, {4, 0.5, 1, 0.92, 0.1}, {9, 0, 1}}, true, 1), {}
    );
    model.transmission = TrainableSet(
        walls({{3, 0.8, 1}, {5, 0, 0.25, 0.85, 0.08}, {7, 0, 1, 0.04, 0.01}}, true, 2), {}
    );
    model.reflection = TrainableSet(walls({{-1.5, 0, 1}, {-3, 0, 1}}, false, 3), {});
    Rng rng(4);
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
    clear_gradient(kSize, 5, dL_dinterface);
    model.backward(weights, {}, true, dL_dinterface);
  }
};

// What a set has in a pixel behind a depth, in double.
struct Surface {
  Vec3d color{}, normal{};
  double t = 0, s = 0, alpha = 0, depth_sum = 0, median = 0;
  double depth() const { return alpha > 0 ? depth_sum / alpha : 0; }
};

class Reference {
 public:
  explicit Reference(Fixture& f) : f_(f) {}

  // The radiance of a pixel by the sum over layers; false: it is near a jump of the rasteriser.
  bool pixel(int x, int y, Vec3d& radiance) {
    double light = 1, limit = 0;
    jump_ = 1;
    radiance = {};
    bool is_pane = false;
    Surface surface = see(f_.model.interface, x, y, 0), others{};
    for (int m = 1; m <= f_.config.layers; ++m) {
      const Vec3d n = (1 / std::sqrt(dot(surface.normal, surface.normal))) * surface.normal;
      const Vec3d d = direction(x, y);
      const double f = 0.04 + 0.96 * std::pow(1 + dot(n, d), 5);
      const double fresnel = m == 1 || surface.t > 0.5 ? f : 0;
      const double k = m <= 2 ? surface.s + (1 - surface.s) * fresnel : 0;
      radiance += light * (1 - k) * (1 - surface.t) * surface.color;
      if (k > 0) radiance += light * k * mirrored(surface.depth(), n, d);
      light *= (1 - k) * surface.t;
      const double pane_limit = std::max(limit, surface.depth() + kPaneGap);
      limit = m == 1 ? surface.depth() : std::max(limit, surface.depth() + (is_pane ? 0 : kGap));
      others = see(f_.model.transmission, x, y, limit);
      if (m == f_.config.layers || light < 0.02) break;
      const Surface pane = see(f_.model.interface, x, y, pane_limit);
      const bool nearer = pane.t > 0.5 && (others.median <= 0 || pane.depth() < others.median);
      surface = nearer ? pane : others;
      is_pane = nearer;
      panes += nearer;
    }
    radiance += light * others.color;
    return jump_ > 2e-4;
  }
  int panes = 0;  // that were nearer

 private:
  static Vec3d direction(int x, int y) {
    const Vec3d d{(x + 0.5 - camera().cx) / camera().fx, (y + 0.5 - camera().cy) / camera().fy, 1};
    return (1 / std::sqrt(dot(d, d))) * d;
  }
  Surface see(const SurfelSet& set, int x, int y, double limit) {
    ActivatedSurfels activated;
    activate(set.cloud(), {}, 0, activated);
    ReferenceInput input = reference_input(raster_input(set.cloud(), activated));
    const Image near(kSize.width, kSize.height, 1, static_cast<float>(limit));
    if (limit > 0) input.near_limit = near;
    const ReferencePixel p = ReferenceRenderer(input, camera(), {}).pixel(x, y);
    jump_ = std::min(jump_, p.cutoffs.nearest_jump_or_median());
    const auto& c = p.features;
    return {{c[0], c[1], c[2]}, p.normal, c[3], c[4], p.alpha, p.depth_sum, p.depth_median};
  }
  Vec3d mirrored(double depth, Vec3d n, Vec3d d) {
    const Vec3d w = d - 2 * dot(n, d) * n;
    const Vec3d at = (depth / d.z) * d;
    Rays rays{Image(1, 1, 3), Image(1, 1, 3)};
    for (int c = 0; c < 3; ++c) {
      rays.origins.at(0, 0, c) = static_cast<float>(at[c]);
      rays.directions.at(0, 0, c) = static_cast<float>(w[c]);
    }
    ActivatedSurfels activated;
    const SurfelCloud& cloud = f_.model.reflection.cloud();
    activate_geometry(cloud, activated);
    const TraceInput input = trace_input(cloud, activated, 0);
    const ReferenceRay ray =
        reference_trace(reference_trace_input(input, rays), 0, f_.config.mirror.settings(true));
    jump_ = std::min(jump_, ray.nearest_cutoff);
    return ray.color;
  }

  Fixture& f_;
  double jump_ = 1;
};

}  // namespace

TEST_CASE("The picture of several layers is the sum over them, by independent renderers") {
  for (const int layers : {1, 2, 3}) {
    Fixture f(layers);
    const Image image = f.picture();
    Reference reference(f);
    int compared = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        Vec3d expected;
        if (!reference.pixel(x, y, expected)) continue;
        ++compared;
        for (int c = 0; c < 3; ++c) {
          INFO(layers << " layers, pixel " << x << ' ' << y);
          CHECK(static_cast<double>(image.at(x, y, c)) == Approx(expected[c]).margin(2e-4));
        }
      }
    CHECK(compared > 100);
    if (layers > 1) CHECK(reference.panes > 20);
  }
}

TEST_CASE("Gradients reach what every set has at every layer") {
  for (const int layers : {2, 3, 4}) {
    Fixture f(layers);
    f.backward();
    GlintModel& m = f.model;
    const auto check = [&](TrainableSet& set, FloatArray SurfelCloud::*array, const char* name) {
      check_array_gradient([&] { return f.loss(); }, set, array, name);
    };
    check(m.interface, &SurfelCloud::sh_dc, "colours of the interface");
    check(m.interface, &SurfelCloud::extra_logits, "t and s of the interface");
    check(m.transmission, &SurfelCloud::sh_dc, "colours behind");
    check(m.transmission, &SurfelCloud::extra_logits, "t and s behind");
    check(m.reflection, &SurfelCloud::sh_dc, "mirrored colours");
    check(m.reflection, &SurfelCloud::opacity_logits, "mirrored opacities");
  }
}

TEST_CASE("Where no light gets behind the interface, layers change nothing") {
  Fixture one(1, 0.01f), two(2, 0.01f);
  CHECK(same_bytes(one.picture(), two.picture()));
}

TEST_CASE("Where the interface has no second pane and nothing behind is glass, t = 0 there") {
  Fixture f(2);
  for (std::size_t i = 0; i < f.model.transmission.cloud().size(); ++i)
    f.model.transmission.cloud().extra_logits[2 * i] = -40;
  const MapSet maps = f.model.render(camera(), f.config, f.phase);
  // To the left, where the interface knows no other pane.
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width / 4; ++x) {
      CHECK(maps["layer_2_transparency"].at(x, y) < 1e-6f);
      CHECK(maps["layer_3_depth"].at(x, y) == maps["layer_2_depth"].at(x, y));
    }
}

TEST_CASE("Maps of layers stand where the walls do, and the parts add up") {
  Fixture f(3);
  const MapSet maps = f.model.render(camera(), f.config, f.phase);
  const int y = kSize.height / 2;
  const auto depth = [&](MapId id, int x) { return maps[id].at(x, y); };
  // Left: pane 2, the transmission set's pane 5, wall 7. Middle: panes 2 and 4, wall 7.
  CHECK(depth("layer_2_depth", 2) == Approx(5).margin(0.2));
  CHECK(depth("layer_3_depth", 2) == Approx(7).margin(0.3));
  CHECK(depth("behind_depth", 2) == Approx(7).margin(0.3));
  CHECK(depth("layer_2_depth", 11) == Approx(4).margin(0.2));
  CHECK(depth("layer_3_depth", 11) == Approx(7).margin(0.3));
  // Right: a thing in front of the far pane.
  CHECK(depth("layer_2_depth", 16) == Approx(3).margin(0.15));
  CHECK(depth("layer_3_depth", 16) == depth("layer_2_depth", 16));
  CHECK(maps.has("layer_4_depth"));
  CHECK_FALSE(maps.has("layer_4_transparency"));  // of what is behind the last layer
  for (int x = 0; x < kSize.width; ++x)
    for (int c = 0; c < 3; ++c) {
      const float through =
          maps["path_t"].at(x, y, c) + maps["path_tt"].at(x, y, c) + maps["path_tr"].at(x, y, c);
      CHECK(through == Approx(maps["transmitted"].at(x, y, c)).margin(1e-5));
    }
}

TEST_CASE("Where panes are known, their backs mirror in the place of the second layer") {
  Fixture f(2);
  const std::vector<Wall> behind = {{7, 0, 1, 0.04, 0.01}, {3, 0.8, 1}};
  f.model.transmission = TrainableSet(walls(behind, true, 2), {});
  const std::size_t far_wall = walls({behind[0]}, true, 2).sh_dc.size();
  const Image without = f.picture();
  MirrorPlane front;  // of the far pane, seen from the other side
  front.center = {0, 0, 4}, front.normal = {0, 0, 1}, front.across = {-1, 0, 0};
  front.half_width = 2, front.half_height = 1, front.pane = true;
  f.model.set_planes({front});
  const MapSet maps = f.model.render(camera(), f.config, f.phase);
  Fixture one(1);
  one.model.transmission = TrainableSet(walls(behind, true, 2), {});
  one.model.set_planes({front});
  const Image& alone = one.picture();
  int known = 0;
  for (std::size_t i = 0; i < kSize.num_pixels(); ++i) {
    if (std::abs(maps["layer_2_depth"].data()[i] - 4) > 1e-5f) continue;
    ++known;  // the thing at 3 m hides the others
    CHECK(maps["layer_2_transparency"].data()[i] == 1);
    CHECK(maps["layer_3_depth"].data()[i] == Approx(7).margin(0.3));
    CHECK(length(get3(maps["layer_2_normal"].data(), i) - Vec3f{0, 0, -1}) < 1e-6f);
    CHECK(length(get3(maps["path_t"].data(), i)) < 1e-6f);
    CHECK(length(get3(maps["rgb"].data(), i) - get3(alone.data(), i)) < 1e-6f);
  }
  CHECK(known > 100);
  CHECK(known < 160);
  int mirrored = 0;
  for (std::size_t i = 0; i < maps["rgb"].values().size(); ++i) {
    const auto value = [&](MapId id) { return maps[id].data()[i]; };
    const float sum = value("path_t") + value("path_tt") + value("path_tr");
    CHECK(sum == Approx(value("transmitted")).margin(1e-5));
    mirrored += value("path_tr") > 1e-3f ? 1 : 0;
  }
  CHECK(mirrored > 100);
  CHECK_FALSE(same_bytes(maps["rgb"], without));
  f.backward();
  check_array_gradient(
      [&] { return f.loss(); }, f.model.transmission, &SurfelCloud::sh_dc, "far wall", far_wall
  );
}

// V2: k_s2 = k_t0 s_tr, k_t = k_t0 (1 - s_tr), C = k_d L_intr + k_s L_refl + k_t L_trans
// + k_s2 L_refl2, with k_t0 = (1 - k_s) t and k_d = (1 - k_s)(1 - t).
TEST_CASE("The official code's path of second order is two layers, the inner one without t") {
  Rng rng(6);
  const auto color = [&] { return Vec3d{rng.uniform(), rng.uniform(), rng.uniform()}; };
  for (int k = 0; k < 20; ++k) {
    const Vec3d intr = color(), refl = color(), trans = color(), refl2 = color();
    const double t = rng.uniform(), ks = rng.uniform(), s2 = rng.uniform();
    const GlassRadiance<double> inner{trans, {}, refl2, 0, s2};
    const Vec3d nested =
        outgoing_radiance(GlassRadiance<double>{intr, outgoing_radiance(inner), refl, t, ks});
    const double kt0 = (1 - ks) * t, kd = (1 - ks) * (1 - t);
    const Vec3d official = kd * intr + ks * refl + kt0 * (1 - s2) * trans + (kt0 * s2) * refl2;
    for (int c = 0; c < 3; ++c) CHECK(nested[c] == Approx(official[c]).epsilon(1e-12));
  }
}
