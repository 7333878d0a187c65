// SPDX-License-Identifier: MIT
// Everything a training step calls, on GPU backends as on the CPU. The CPU's results are checked
// elsewhere, against the formulas and by central differences.
#include "glint/cuda/ops.h"

#include <catch2/catch.hpp>

#include "glint/render/glass_transport.h"
#include "glint/render/map_ops.h"
#include "glint/train/geometry_losses.h"
#include "glint/train/photometric.h"
#include "glint/train/trainable_set.h"
#include "glint/train/transparency_guidance.h"
#include "glint/train/transparency_prior.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/random_scene.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

using Results = std::map<std::string, std::vector<float>>;
constexpr ImageSize kSize{37, 26};
constexpr double kRounding = 2e-5;  // of one op in float
constexpr double kReordered =
    1e-4;  // where sums over many pixels or hits are taken in another order

Image noise(int channels, std::uint64_t seed, float low, float high) {
  return random_map(kSize, channels, low, high, seed);
}
Image unit_vectors(std::uint64_t seed) {
  Image image = noise(3, seed, -1, 1);
  for (std::size_t i = 0; i < image.num_pixels(); ++i) {
    float* n = image.data() + 3 * i;
    const Vec3f unit = normalize(Vec3f{n[0], n[1], n[2]});
    n[0] = unit.x, n[1] = unit.y, n[2] = unit.z;
  }
  return image;
}

Camera test_camera() { return look_at({0, -3, 0.5}, {0, 0, 0}, {0, 0, 1}, kSize, 70); }

SurfelCloud test_cloud() { return ball_of_surfels(300, 11, {"transparency", "specular"}); }
SetTraining training(const DensifyConfig& densify = {}) {
  SetTraining training{.densify = densify, .extent = 2, .seed = 7};
  training.rates.extra = {0.05f, 0.01f};
  return training;
}
TrainableSet test_set() { return TrainableSet(test_cloud(), training()); }

void add_arrays(const std::string& prefix, const SurfelCloud& cloud, Results& results) {
  cloud.for_each_array([&](const char* name, const FloatArray& array, std::size_t) {
    results[prefix + name] = read(array);
  });
}

RasterOutputGradient raster_gradient() {
  RasterOutputGradient g;
  g.features = noise(5, 1, -1, 1);
  g.alpha = noise(1, 2, -1, 1);
  g.depth_sum = noise(1, 3, -1, 1);
  g.normal = noise(3, 4, -1, 1);
  return g;
}

}  // namespace

TEST_CASE("A rasterised set is the same on a GPU, forward and backward") {
  check_same_as_cpu(kReordered, [] {
    TrainableSet set = test_set();
    Image near(kSize.width, kSize.height, 1, 2.6f);
    const RasterOutput& out = set.forward(test_camera(), 3, {}, near);
    set.backward(raster_gradient());
    Image depth;
    expected_depth_map(out, depth);
    Results results{
        {"features", read(out.features)},
        {"alpha", read(out.alpha)},
        {"median", read(out.depth_median)},
        {"normal", read(out.normal)},
        {"visibility", read(out.visibility)},
        {"in view", read(out.in_view)},
        {"depth", read(depth)}};
    add_arrays("gradient of ", set.gradient(), results);
    return results;
  });
}

TEST_CASE("Plane distances, statistics, first surfaces and modes are the same on a GPU") {
  check_same_as_cpu(kReordered, [] {
    RasterPass pass;
    const SurfelSet set(test_cloud());
    RasterSettings settings;
    settings.with_plane_distance = settings.with_statistics = true;
    const Image near(kSize.width, kSize.height, 1, 2.4f);
    const RasterOutput& out = set.forward(pass, test_camera(), 0, settings, near);
    RasterOutputGradient g = raster_gradient();
    g.plane_distance = noise(1, 5, -1, 1);
    const RasterGradient& gradient = pass.rasterizer.backward(g);
    Image depth, first, last;
    pass.rasterizer.first_surface(noise(1, 6, 0, 1), {.window = 0.1f}, depth);
    pass.rasterizer.depth_modes({.width = 0.1f}, first, last);
    return Results{
        {"plane distance", read(out.plane_distance)},
        {"owned pixels", read(out.owned_pixels)},
        {"radii", read(out.radii)},
        {"gradient of means", read(gradient.means)},
        {"absolute screen gradient", read(gradient.screen_abs)},
        {"first surface", read(depth)},
        {"first mode", read(first)},
        {"last mode", read(last)}};
  });
}

TEST_CASE("A traced set is the same on a GPU, forward and backward") {
  check_same_as_cpu(kReordered, [] {
    TrainableSet set = test_set();
    Rays rays;
    camera_rays(test_camera(), rays);
    TraceOutputGradient g{noise(3, 1, -1, 1), noise(1, 2, -1, 1), noise(1, 3, -1, 1), {}};
    const TraceOutput& out = set.trace(rays, 2);
    const Rays& dL_drays = set.trace_backward(g);
    Results results{
        {"color", read(out.color)},
        {"alpha", read(out.alpha)},
        {"depth", read(out.depth_sum)},
        {"normal", read(out.normal)},
        {"gradient of origins", read(dL_drays.origins)},
        {"gradient of directions", read(dL_drays.directions)}};
    add_arrays("gradient of ", set.gradient(), results);
    return results;
  });
}

TEST_CASE("The optimiser and density control do the same on a GPU") {
  check_same_as_cpu(kReordered, [] {
    DensifyConfig densify;
    densify.from = 1;
    densify.interval = 4;
    densify.reset_interval = 5;
    densify.prune_holiday = 0;
    densify.split_large = true;
    densify.gradient_threshold = 1e-3f;
    TrainableSet set(test_cloud(), training(densify));
    for (int step = 1; step <= 6; ++step) {
      set.forward(test_camera(), 3);
      set.backward(raster_gradient());
      set.update(step);
    }
    Results results;
    add_arrays("", set.cloud(), results);
    CHECK(set.cloud().size() != test_cloud().size());
    return results;
  });
}

TEST_CASE("What PGSR adds to density control is the same on a GPU") {
  check_same_as_cpu(kReordered, [] {
    DensifyConfig densify;
    densify.from = 1;
    densify.interval = 2;
    densify.gradient_threshold = 3e-3f;
    densify.sample_clones = true;
    densify.max_abs_splits = 40;
    densify.abs_gradient = 5e-3f;
    densify.abs_radius_px = 40;
    TrainableSet set(test_cloud(), training(densify));
    const Camera cameras[] = {
        test_camera(), look_at({1.5, -2.5, 0.5}, {0, 0, 0}, {0, 0, 1}, kSize, 70)};
    RasterSettings settings;
    settings.with_statistics = true;
    for (int step = 1; step <= 3; ++step) {
      set.forward(test_camera(), 3, settings);
      set.backward(raster_gradient());
      const DensifyCounts counts = set.update(step);
      if (step == 2) CHECK(counts.cloned + counts.split > 0);
    }
    CHECK(set.trim(cameras) > 0);
    Results results;
    add_arrays("", set.cloud(), results);
    return results;
  });
}

TEST_CASE("Transport between the sets is the same on a GPU") {
  check_same_as_cpu(kRounding, [] {
    TrainableSet set = test_set();
    const RasterOutput& out = set.forward(test_camera(), 3);
    GlassTransport transport({.channels = interface_channels(set.cloud())});
    const GlassBuffer& buffer = transport.read_interface(test_camera(), out);
    GlassLayers layers{{}, noise(3, 5, 0, 1), noise(3, 6, 0, 1)};
    copy_color(out.features, layers.interface);
    const Image& image = transport.compose(layers);
    const GlassLayers& dL_dlayers = transport.compose_vjp(layers, noise(3, 7, -1, 1));
    const Rays dL_drays{noise(3, 8, -1, 1), noise(3, 9, -1, 1)};
    RasterOutputGradient g;
    clear_gradient(kSize, out.features.channels(), g);
    transport.interface_vjp(test_camera(), out, &dL_drays, noise(1, 10, -1, 1), g);
    return Results{
        {"image", read(image)},
        {"origins", read(buffer.reflected.origins)},
        {"directions", read(buffer.reflected.directions)},
        {"specularity", read(buffer.specularity)},
        {"gradient of transmission", read(dL_dlayers.transmission)},
        {"gradient of features", read(g.features)},
        {"gradient of normal", read(g.normal)},
        {"gradient of depth", read(g.depth_sum)}};
  });
}

TEST_CASE("The photometric loss is the same on a GPU") {
  check_same_as_cpu(kRounding, [] {
    PhotometricLoss loss;
    Image gradient(kSize.width, kSize.height, 3);
    const auto terms =
        loss.evaluate(noise(3, 1, -0.1f, 1.1f), noise(3, 2, 0, 1), {0.8f, 0.2f}, gradient);
    return Results{
        {"gradient", read(gradient)},
        {"terms",
         {static_cast<float>(terms.l1),
          static_cast<float>(terms.ssim_loss),
          static_cast<float>(terms.mse)}}};
  });
}

TEST_CASE("Losses on depth and normals are the same on a GPU") {
  check_same_as_cpu(kRounding, [] {
    Scene scene;
    scene.name = "noise";
    View view;
    view.camera = test_camera();
    view.rgb = noise(3, 3, 0, 1);
    view.priors["depth"] = noise(1, 4, 0.2f, 1);
    view.priors["normal"] = unit_vectors(5);
    scene.train = {view};
    GeometryLossConfig config;
    config.lambda_depth = config.lambda_normal = config.lambda_consistency = config.lambda_smooth =
        0.5f;
    config.gate_from = 0;
    config.depth_gradient_scales = 3;
    config.near_first = true;
    GeometryLosses losses;
    CHECK(losses.set_up(config, scene, "test").empty());
    RasterOutput out;
    out.normal = noise(3, 6, -1, 1);
    out.alpha = noise(1, 7, 0.1f, 1);
    out.depth_sum = noise(1, 8, 0.5f, 3);
    Image depth;
    expected_depth_map(out, depth);
    RasterOutputGradient g;
    clear_gradient(kSize, 3, g);
    StepStats stats;
    losses.add(view, 10, out, depth, g, stats);
    Results results{
        {"normal", read(g.normal)}, {"depth", read(g.depth_sum)}, {"alpha", read(g.alpha)}};
    for (const auto& [name, value] : stats.terms) results[name] = {static_cast<float>(value)};
    return results;
  });
}

TEST_CASE("Losses on transparency are the same on a GPU") {
  for (const auto& guidance : {TransparencyGuidance::paper(), TransparencyGuidance::release()})
    check_same_as_cpu(kRounding, [&] {
      const Image z = noise(1, 1, 1, 2), behind = noise(1, 2, 1, 2.5f);
      const Image albedo = noise(3, 3, 0, 0.15f), base = noise(3, 4, 0, 0.6f);
      const Image cosine = viewing_cosines(test_camera(), unit_vectors(5));
      const TransparencyMasks masks = guidance.masks({z, behind, albedo, base, cosine});
      const Image t = noise(1, 6, 0.01f, 0.99f);
      Image gradient(kSize.width, kSize.height, 1), prior_gradient(gradient);
      const double loss = guidance.evaluate(t, masks, 1.0f, gradient);
      const double prior =
          TransparencyPriorLoss{}.evaluate(t, noise(3, 7, 0, 1), 1.0f, prior_gradient);
      return Results{
          {"transparent", read(masks.transparent)},
          {"opaque", read(masks.opaque)},
          {"cosines", read(cosine)},
          {"gradient", read(gradient)},
          {"gradient of the prior", read(prior_gradient)},
          {"losses", {static_cast<float>(loss), static_cast<float>(prior)}}};
    });
}

TEST_CASE("A kernel that no GPU backend offers is refused by name") {
  struct Unknown {
    void operator()(std::size_t) const {}
  };
  const OnHost on_host;
  CHECK_THROWS_WITH(run_kernel(1, 1, Unknown{}), Catch::Contains("Unknown"));
}
