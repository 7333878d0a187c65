// SPDX-License-Identifier: MIT
// What PGSR adds to density control: sampled clones, splits by the absolute gradient, trimming.
#include <catch2/catch.hpp>

#include <array>
#include <cmath>

#include "glint/render/activations.h"
#include "glint/render/void_steps.h"
#include "glint/train/trainable_set.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/host_exec.h"

using namespace glint;

namespace {

constexpr float kScale = 0.2f;  // metres

// Surfels in planes of their own, metres apart.
SurfelCloud cloud_of(std::size_t count) {
  SurfelCloud cloud;
  cloud.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    cloud.means[3 * i] = 100 * static_cast<float>(i);
    const float q[4] = {0.9f, 0.1f * static_cast<float>(i), -0.3f, 0.2f};
    std::copy_n(q, 4, &cloud.rotations[4 * i]);
    cloud.opacity_logits[i] = 1;
    cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = std::log(kScale);
  }
  return cloud;
}

struct Seen {
  float gradient, abs_gradient, radius;
  float owned_pixels = 1;
};

// A view of so many rows that saw every surfel; gradients as they are at 540 rows.
void observe(Densifier& densifier, const std::vector<Seen>& surfels, int rows = 540) {
  RasterOutput output;
  output.in_view.assign(surfels.size(), 1);
  output.alpha = Image(16, rows, 1);
  RasterGradient gradient;
  const float scale = 540.0f / static_cast<float>(rows);
  for (const Seen& s : surfels) {
    for (const float value : {0.0f, scale * s.gradient}) gradient.screen.push_back(value);
    for (const float value : {0.6f * scale * s.abs_gradient, 0.8f * scale * s.abs_gradient})
      gradient.screen_abs.push_back(value);
    output.radii.push_back(s.radius / scale);
    output.owned_pixels.push_back(s.owned_pixels);
  }
  densifier.observe(output, gradient);
}

DensifyConfig every_step() {
  DensifyConfig config;
  config.from = 0;
  config.interval = 1;
  config.clone_scale = 1000;  // clones, no splits
  config.max_scale = 1000;
  return config;
}

// All are as large as what is split.
DensifyConfig splitting_by_abs(int max_splits) {
  DensifyConfig config = every_step();
  config.clone_scale = kScale / 2;
  config.max_abs_splits = max_splits;
  return config;
}

struct Run {
  SurfelCloud cloud;
  DensifyCounts counts;
};

Run densified(const DensifyConfig& config, const std::vector<Seen>& surfels, int rows = 540) {
  Run run{cloud_of(surfels.size()), {}};
  SurfelAdam adam;
  Densifier densifier(config, 1, 5);
  observe(densifier, surfels, rows);
  run.counts = densifier.update(1, run.cloud, adam);
  CHECK(adam.first().size() == run.cloud.size());
  return run;
}

constexpr Seen kQuiet{0, 0, 1}, kMoving{1e-3f, 0, 1};

}  // namespace

TEST_CASE("Clones lie on their surfel, or where they are drawn from it: in its plane") {
  DensifyConfig config = every_step();
  const std::vector<Seen> seen(8, kMoving);
  const SurfelCloud plain = densified(config, seen).cloud;
  config.sample_clones = true;
  const SurfelCloud sampled = densified(config, seen).cloud;
  const SurfelCloud again = densified(config, seen).cloud;
  REQUIRE(plain.size() == 16);
  REQUIRE(sampled.size() == 16);
  CHECK(sampled.means == again.means);
  CHECK(sampled.log_scales == plain.log_scales);
  double squares = 0;
  for (std::size_t i = 8; i < 16; ++i) {
    Vec3f of_plain, of_sampled;
    for (int k = 0; k < 3; ++k) {
      of_plain[k] = plain.means[3 * i + k] - plain.means[3 * (i - 8) + k];
      of_sampled[k] = sampled.means[3 * i + k] - sampled.means[3 * (i - 8) + k];
    }
    CHECK(length(of_plain) == 0);
    const float* q = &sampled.rotations[4 * i];
    const Vec3f normal = column(rotation_matrix(Vec4f{q[0], q[1], q[2], q[3]}), 2);
    CHECK(std::abs(dot(normal, of_sampled)) < 1e-4f);  // rounding of means up to 700
    CHECK(length(of_sampled) > 0);
    squares += static_cast<double>(dot(of_sampled, of_sampled));
  }
  // 16 squared normals of this variance: outside a factor of 3 in one draw of a hundred.
  CHECK(squares > 16 * 0.04 / 3);
  CHECK(squares < 16 * 0.04 * 3);
}

TEST_CASE("A surfel is split by its absolute gradient only where it is large, too") {
  DensifyConfig config = splitting_by_abs(0);
  const std::vector<Seen> seen = {{0, 9e-4f, 21}, {0, 9e-4f, 19}, {0, 7e-4f, 21}, kQuiet};
  const int rows = GENERATE(540, 270, 1080);               // of other images: as at 540
  CHECK(densified(config, seen, rows).counts.split == 0);  // off
  config.max_abs_splits = 10;
  const Run run = densified(config, seen, rows);
  CHECK(run.counts.split == 1);
  CHECK(run.counts.cloned == 0);
  REQUIRE(run.cloud.size() == 5);  // 3 stay, the first is two children
  CHECK(run.cloud.means[0] == 100);
  for (const std::size_t child : {3u, 4u})
    CHECK(run.cloud.log_scales[2 * child] == Approx(std::log(kScale / 1.6f)));
  config.clone_scale = 2 * kScale;  // in the image, but not in the scene
  CHECK(densified(config, seen, rows).counts.split == 0);
}

TEST_CASE("A radius counts in views where the surfel is in front") {
  const std::vector<Seen> seen = {{0, 9e-4f, 21, 0}, {0, 9e-4f, 21, 1}};
  CHECK(densified(splitting_by_abs(10), seen).counts.split == 1);
}

TEST_CASE("The largest absolute gradients are split first, and not what is split already") {
  DensifyConfig config = splitting_by_abs(2);
  const std::vector<Seen> seen = {
      {0, 1e-3f, 30}, {1e-3f, 9e-3f, 30}, {0, 4e-3f, 30}, {0, 2e-3f, 30}};
  const Run run = densified(config, seen);
  CHECK(run.counts.cloned == 0);
  CHECK(run.counts.split == 3);
  REQUIRE(run.cloud.size() == 7);  // 0, children of 1, 2 and 3
  CHECK(run.cloud.means[0] == 0);

  config.max_surfels = 6;  // room for two
  CHECK(densified(config, seen).counts.split == 2);
}

TEST_CASE("The mean is over views, the radius the largest since the last densification") {
  SurfelCloud cloud = cloud_of(2);
  SurfelAdam adam;
  Densifier densifier(splitting_by_abs(10), 1, 5);
  observe(densifier, {{0, 1.5e-3f, 25}, {0, 2e-3f, 5}});
  observe(densifier, {{0, 0, 5}, {0, 2e-3f, 5}});
  CHECK(densifier.update(1, cloud, adam).split == 0);  // mean 7.5e-4; never large
  observe(densifier, {{0, 2e-3f, 5}, {0, 2e-3f, 21}});
  CHECK(densifier.update(2, cloud, adam).split == 1);  // the first was large before that only
}

TEST_CASE("The mean gradient may be over views where the surfel has weight") {
  DensifyConfig config = every_step();
  for (const bool only_weighted : {false, true}) {
    config.only_weighted_views = only_weighted;
    SurfelCloud cloud = cloud_of(1);
    SurfelAdam adam;
    Densifier densifier(config, 1, 5);
    RasterOutput output;
    output.in_view.assign(1, 1);
    output.alpha = Image(16, 540, 1);
    RasterGradient gradient;
    gradient.screen = {0, 3e-4f};  // threshold: 2e-4
    for (const float weight : {1.0f, 0.0f}) {
      output.visibility.assign(1, weight);
      densifier.observe(output, gradient);
      gradient.screen = {0, 0};
    }
    CHECK(densifier.update(1, cloud, adam).cloned == (only_weighted ? 1 : 0));
  }
}

TEST_CASE("A void step leaves what was observed as it is") {
  const test::OnHost on_host;
  SurfelCloud cloud = cloud_of(2);
  SurfelAdam adam;
  Densifier densifier(splitting_by_abs(10), 1, 5);
  observe(densifier, {{0, 2e-3f, 5}, {0, 0, 25}});
  {
    const SilentStep silent(true);
    test::HostExec().for_each(1, [word = void_word()](std::size_t) { *word = 1; });
    observe(densifier, {{1e-3f, 2e-3f, 25}, {1e-3f, 2e-3f, 25}});
    end_silent_step();
  }
  CHECK(take_void_steps().count == 1);
  const DensifyCounts counts = densifier.update(1, cloud, adam);
  CHECK(counts.cloned == 0);
  CHECK(counts.split == 0);
}

TEST_CASE("Splits by the absolute gradient ask for the statistics they need") {
  DensifyConfig config = every_step();
  config.max_abs_splits = 10;
  Densifier densifier(config, 1, 5);
  RasterOutput output;
  output.in_view.assign(1, 1);
  output.alpha = Image(16, 540, 1);
  RasterGradient gradient;
  gradient.screen = {0, 0};
  CHECK_THROWS_WITH(densifier.observe(output, gradient), Catch::Contains("with_statistics"));
}

TEST_CASE("What is pruned goes with its moments and with what was observed of it") {
  SurfelCloud cloud = cloud_of(4), gradient = cloud_of(4);
  for (std::size_t i = 0; i < 4; ++i) gradient.means[3 * i] = static_cast<float>(i + 1);
  SurfelAdam adam;
  adam.step(cloud, gradient, {}, 1);
  const float moment = adam.first().means[9];
  Densifier densifier(every_step(), 1, 5);
  observe(densifier, {kMoving, kQuiet, kQuiet, kMoving});
  densifier.prune({0, 1, 0, 1}, cloud, adam);
  REQUIRE(cloud.size() == 2);
  REQUIRE(adam.first().size() == 2);
  CHECK(adam.first().means[3] == moment);
  CHECK(densifier.update(1, cloud, adam).cloned == 1);
  CHECK(cloud.means[6] == cloud.means[3]);
}

namespace {

// A wall at z = 2 that faces cameras at the origin, and what a case adds.
SurfelCloud wall_and(const std::vector<Vec3f>& others) {
  SurfelCloud cloud;
  cloud.resize(1 + others.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3f mean = i == 0 ? Vec3f{0, 0, 2} : others[i - 1];
    for (int k = 0; k < 3; ++k) cloud.means[3 * i + k] = mean[k];
    cloud.rotations[4 * i] = 1;
    cloud.opacity_logits[i] = logit(0.95f);
    cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = std::log(i == 0 ? 5.0f : 0.1f);
  }
  return cloud;
}

Camera camera_at(double x) {
  Camera camera;
  camera.width = camera.height = 21;
  camera.fx = camera.fy = 20;
  camera.cx = camera.cy = 10.5;
  camera.translation_cam_from_world = {-x, 0, 0};
  return camera;
}

std::vector<float> columns(const SurfelCloud& cloud) {
  std::vector<float> z;
  for (std::size_t i = 0; i < cloud.size(); ++i) z.push_back(cloud.means[3 * i + 2]);
  return z;
}

}  // namespace

TEST_CASE("Trimming drops what owns a pixel in fewer than two training views") {
  // Behind the wall; before it and in two views; before it and in one of them.
  TrainableSet set(wall_and({{0, 0, 3}, {0, 0, 1}, {-0.6f, 0, 1.25f}}), SetTraining{});
  const std::array cameras{camera_at(0), camera_at(0.2), camera_at(0.4)};
  const std::array far_apart{camera_at(0), camera_at(0.4)};
  SECTION("two views see the right one, three the other") {
    CHECK(set.trim(cameras) == 1);
    CHECK(columns(set.cloud()) == std::vector<float>{2, 1, 1.25f});
  }
  SECTION("only one sees the last") {
    CHECK(set.trim(far_apart) == 2);
    CHECK(columns(set.cloud()) == std::vector<float>{2, 1});
  }
  SECTION("one view is enough where there is one only") {
    CHECK(set.trim(std::span(cameras).first(1)) == 1);
    CHECK(columns(set.cloud()) == std::vector<float>{2, 1, 1.25f});
  }
  SECTION("frozen geometry stays") {
    set.freeze_geometry();
    CHECK(set.trim(cameras) == 0);
    CHECK(set.cloud().size() == 4);
  }
  CHECK(set.gradient().size() == set.cloud().size());
  // The set goes on.
  const RasterOutput& output = set.forward(camera_at(0), 0);
  RasterOutputGradient dL;
  dL.alpha = Image(21, 21, 1, 1.0f);
  CHECK(output.visibility.size() == set.cloud().size());
  set.backward(dL);
  set.update(1);
}

TEST_CASE("Trimming in a silent step of a GPU sees all of each view, whatever the first one needed"
) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 40; ++i) points.push_back({0.02f * static_cast<float>(i) - 0.4f, 0.1f, 1});
  const std::array cameras{
      camera_at(1000), camera_at(0), camera_at(0.2)};  // the first sees nothing
  const auto trimmed = [&] {
    TrainableSet set(wall_and(points), SetTraining{});
    const SilentStep silent(true);
    set.trim(cameras);
    return columns(set.cloud());
  };
  const std::vector<float> expected = trimmed();
  CHECK(expected.size() > 5);
  const test::OnHost on_host;
  CHECK(trimmed() == expected);
}
