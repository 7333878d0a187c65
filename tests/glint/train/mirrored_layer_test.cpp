// SPDX-License-Identifier: MIT
// How far mirrored rays go in training, and that pictures have all of them to the end.
#include "glint/train/mirrored_layer.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <map>
#include <numeric>

#include "glint/core/rng.h"
#include "glint/render/spherical_harmonics.h"
#include "glint/train/training_state.h"
#include "tests/support/same_bytes.h"

using namespace glint;
using test::same_bytes;

namespace {

constexpr ImageSize kSize{24, 16};

// A fog of surfels in front of a wall that mirrors anything from little to nearly all. Their
// colours are at most 1.
TrainableSet fog(Rng& rng) {
  PointCloud points;
  for (int i = 0; i < 1500; ++i) {
    points.positions.push_back({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.1f, 3)});
    points.colors.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
  }
  return TrainableSet(points, {}, {});
}

GlassBuffer wall(Rng& rng) {
  GlassBuffer b;
  b.depth = Image(kSize.width, kSize.height, 1, 2.0f);
  b.transparency = b.specularity = Image(kSize.width, kSize.height, 1);
  b.normal = b.reflected.origins = b.reflected.directions = Image(kSize.width, kSize.height, 3);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      b.specularity.at(x, y) = 0.5f * rng.uniform() * rng.uniform();
      b.normal.at(x, y, 2) = -1;
      b.reflected.origins.at(x, y, 0) = 0.05f * static_cast<float>(x - 12);
      b.reflected.origins.at(x, y, 1) = 0.05f * static_cast<float>(y - 8);
      b.reflected.directions.at(x, y, 2) = 1;
    }
  return b;
}

}  // namespace

TEST_CASE("Pictures have mirrored rays to the end, where training stops before") {
  Rng rng(4);
  TrainableSet set = fog(rng);
  const GlassBuffer buffer = wall(rng);
  MirrorCutoffs mirror;
  mirror.share_below = 0;
  MirroredLayer layer;
  Image training, picture, whole;
  layer.trace(buffer, set, 0, mirror, 3, training);
  layer.trace(buffer, set, 0, mirror, {}, picture);
  CHECK_FALSE(same_bytes(training, picture));
  mirror.transmittance = kMinTransmittance;
  mirror.hits = 256;
  layer.trace(buffer, set, 0, mirror, 3, whole);
  CHECK(same_bytes(whole, picture));
}

namespace {

// Arrays of a training's state by name, as they are now.
class Recorder final : public TrainingState {
 public:
  std::map<std::string, std::vector<double>> arrays;
  bool reading() const override { return false; }

 private:
  template <class T>
  void keep(const std::string& name, std::size_t count, const void* values) {
    const T* first = static_cast<const T*>(values);
    arrays[name].assign(first, first + count);
  }
  void exchange(const std::string&, std::string&) override {}
  void exchange(
      const std::string& name,
      TensorType type,
      std::size_t count,
      const std::function<void*(std::size_t count)>& place
  ) override {
    if (type == kTensorTypeOf<float>) keep<float>(name, count, place(count));
    if (type == kTensorTypeOf<std::uint32_t>) keep<std::uint32_t>(name, count, place(count));
  }
};

// The mean gradient that density control knows of each surfel after so many steps of one view,
// whose pixels are 0.05 m apart; 0: seen in none.
std::vector<double> statistic(float scale, float share_below, int observe_every, int steps) {
  Rng rng(7);
  TrainableSet set = fog(rng);
  set.cloud().log_scales.fill(std::log(scale));
  GlassBuffer buffer = wall(rng);
  for (float& k : buffer.specularity.values()) k *= 0.3f;  // all share where they may
  MirrorCutoffs mirror;
  mirror.share_below = share_below;
  mirror.observe_every = observe_every;
  MirroredLayer layer;
  Image color;
  const Image gradient(kSize.width, kSize.height, 3, 0.01f);
  for (int step = 0; step < steps; ++step) {
    layer.trace(buffer, set, 0, mirror, step, color);
    layer.trace_backward(set, gradient);
  }
  Recorder recorder;
  set.visit_state(recorder);
  std::vector<double> mean = recorder.arrays.at("densifier.gradient_sum");
  const std::vector<double>& views = recorder.arrays.at("densifier.views");
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] /= std::max(views[i], 1.0);
  return mean;
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

TEST_CASE("What density control expects of a surfel does not depend on whether rays are shared") {
  for (const float pixels : {0.1f, 0.5f, 2.0f}) {
    // One view whose pixels stay: each observed step is the same, so the expectation is exact.
    const std::vector<double> own = statistic(0.05f * pixels, 0, 4, 4);
    const std::vector<double> shared = statistic(0.05f * pixels, 0.2f, 4, 16);
    REQUIRE(own.size() == shared.size());
    for (std::size_t i = 0; i < own.size(); ++i) CHECK(own[i] == Approx(shared[i]).epsilon(1e-5));
    CHECK(sum_of(own) > 0);
  }
  // Counted in every step it does: where a small surfel is hit, the ray has its block's gradients.
  CHECK(sum_of(statistic(0.005f, 0.2f, 0, 16)) > 2 * sum_of(statistic(0.005f, 0, 0, 16)));
}

TEST_CASE("A set that grows no more shares rays in every step") {
  MirrorCutoffs mirror;
  CHECK(mirror.observes(0));
  CHECK_FALSE(mirror.observes(1));
  mirror.share_below = 0;
  CHECK(mirror.observes(1));
  Rng rng(8);
  const SurfelCloud cloud = fog(rng).cloud();
  SetTraining training;
  training.densify.until = 0;
  CHECK_FALSE(TrainableSet(cloud, training).grows());
  CHECK_FALSE(TrainableSet(cloud).grows());
  CHECK(fog(rng).grows());
}
