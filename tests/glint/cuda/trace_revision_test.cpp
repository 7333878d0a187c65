// SPDX-License-Identifier: MIT
// The GPU's tracer fits its tree to a set that was written, and to no other, whoever wrote it.
#include <catch2/catch.hpp>
#include <functional>

#include "glint/cuda/bvh_bodies.h"
#include "glint/render/glass_transport.h"
#include "glint/train/trainable_set.h"
#include "tests/support/count_launches.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{16, 12};

Rays rays_of_camera() {
  Rays rays;
  camera_rays(look_at({0, -3, 0.5}, {0, 0, 0}, {0, 0, 1}, kSize, 60), rays);
  return rays;
}

struct Picture {
  std::vector<float> color, depth;
  int fits = 0;
};
Picture picture_of(SurfelSet& set, const Rays& rays, const TraceSettings& settings = {}) {
  const CountedLaunches fits(typeid(gpu::FitBoxes));
  const TraceOutput& out = set.trace(rays, 2, settings);
  const int count = fits.count;
  return {read(out.color), read(out.depth_sum), count};
}

void add_to_first(FloatArray& array, float by) { array[0] += by; }

struct Change {
  const char* name;
  std::function<void(TrainableSet&)> make;
};
TrainableSet training_set() {
  DensifyConfig densify;
  densify.from = 0;
  densify.interval = 1;
  densify.gradient_threshold = 1e-7f;
  return TrainableSet(
      ball_of_surfels(200, 1), SetTraining{.densify = densify, .extent = 2, .seed = 7}
  );
}
void train_one_step(TrainableSet& set, int step) {
  Image ones(kSize.width, kSize.height, 3, 1.0f);
  set.trace_backward({ones, {}, {}, {}});
  set.update(step);
}

const Change kChanges[] = {
    {"Adam", [](TrainableSet& set) { train_one_step(set, 1); }},
    {"density control", [](TrainableSet& set) { train_one_step(set, 2); }},
    {"loading", [](TrainableSet& set) { set.load(ball_of_surfels(150, 2)); }},
    {"loading as many",
     [](TrainableSet& set) { set.load(ball_of_surfels(set.cloud().size(), 3)); }},
    {"the host, means", [](TrainableSet& set) { add_to_first(set.cloud().means, 0.3f); }},
    {"the host, scales", [](TrainableSet& set) { add_to_first(set.cloud().log_scales, 1); }},
    {"the host, rotations", [](TrainableSet& set) { add_to_first(set.cloud().rotations, 1); }},
    {"the host, opacities",
     [](TrainableSet& set) { add_to_first(set.cloud().opacity_logits, -2); }},
    {"a fill", [](TrainableSet& set) { set.cloud().log_scales.fill(-1.2f); }},
    {"an array of another set",
     [](TrainableSet& set) { set.cloud().means = ball_of_surfels(set.cloud().size(), 4).means; }},
    {"fewer surfels", [](TrainableSet& set) { set.load(ball_of_surfels(20, 5)); }},
    {"the CPU",
     [](TrainableSet& set) {
       use_cpu();
       for (float& v : set.cloud().means) v *= 0.5f;
       use_host_kernels();
     }},
};

}  // namespace

TEST_CASE("A set that nobody wrote is fitted once, and whatever was written is seen") {
  const OnHost on_host;
  const Rays rays = rays_of_camera();
  TrainableSet set = training_set();
  Picture before = picture_of(set, rays);
  CHECK(before.fits == 1);
  for (const Change& change : kChanges) {
    INFO(change.name);
    const Picture again = picture_of(set, rays);
    CHECK(again.fits == 0);
    CHECK(again.color == before.color);
    change.make(set);
    const Picture found = picture_of(set, rays);
    CHECK(found.fits == 1);
    SurfelSet fresh(set.cloud());
    const Picture expected = picture_of(fresh, rays);
    CHECK(found.color == expected.color);
    CHECK(found.depth == expected.depth);
    CHECK(found.color != before.color);
    before = found;
  }
}

TEST_CASE("Who looks at a set, renders it, changes its colours or traces other rays moves nothing"
) {
  const OnHost on_host;
  const Rays rays = rays_of_camera();
  Rays other = rays;
  for (float& v : other.origins.values()) v += 0.1f;
  TrainableSet set = training_set();
  const Picture before = picture_of(set, rays);
  CHECK(std::as_const(set).cloud().means[0] < 2);
  set.forward(look_at({0, -3, 0.5}, {0, 0, 0}, {0, 0, 1}, kSize, 60), 2);
  CHECK(picture_of(set, other).fits == 0);
  add_to_first(set.cloud().sh_dc, 3);
  const Picture colored = picture_of(set, rays);
  CHECK(colored.fits == 0);
  CHECK(colored.depth == before.depth);
  CHECK(colored.color != before.color);
  TraceSettings settings;
  settings.max_rho = 4;  // boxes are others
  const Picture smaller = picture_of(set, rays, settings);
  CHECK(smaller.fits == 1);
  SurfelSet fresh(set.cloud());
  CHECK(smaller.color == picture_of(fresh, rays, settings).color);
}

TEST_CASE("An array has another revision after each way to write it, and no other has had it") {
  use_host_kernels();
  FloatArray array(5, 1.0f), other(5, 2.0f);
  std::vector<std::uint64_t> seen{array.device_revision(), other.device_revision()};
  CHECK(seen[0] != seen[1]);
  const auto check_kept = [&] {
    const std::uint64_t now = array.device_revision();
    CHECK(std::as_const(array)[2] == std::as_const(array).data()[2]);
    array.device_for_reading();
    CHECK(array.device_revision() == now);
  };
  const std::pair<const char*, std::function<void()>> writes[] = {
      {"the host's data", [&] { array.data()[1] = 3; }},
      {"an element", [&] { array[1] = 4; }},
      {"an iterator", [&] { *array.begin() = 5; }},
      {"a kernel", [&] { array.device_for_writing(); }},
      {"a kernel that overwrites", [&] { array.device_for_overwriting(); }},
      {"fill", [&] { array.fill(3); }},
      {"assign", [&] { array.assign(5, 7.0f); }},
      {"a copy", [&] { array = other; }},
      {"a push", [&] { array.push_back(1); }},
      {"growth", [&] { array.resize(9); }},
      {"fewer", [&] { array.resize(4); }},
      {"nothing and zeros", [&] { array.clear(), array.resize(4); }},
      {"growth of a value", [&] { array.resize(6, 2.0f); }},
      {"a new array", [&] { array = FloatArray(6, 2.0f); }},
  };
  for (const auto& [name, write] : writes) {
    INFO(name);
    check_kept();
    write();
    const std::uint64_t now = array.device_revision();
    CHECK(std::find(seen.begin(), seen.end(), now) == seen.end());
    seen.push_back(now);
  }
  const std::uint64_t moved = array.device_revision();
  const FloatArray owner = std::move(array);
  CHECK(owner.device_revision() == moved);  // the same values in the same place
  use_cpu();
  CHECK(owner.device_revision() == 0);
}
