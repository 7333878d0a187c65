// SPDX-License-Identifier: MIT
// Every registered method is tested by existing: it trains on a small glass room, its loss falls,
// it renders what its contract says, it saves and loads, it is deterministic, it refuses bad
// config.
#include <catch2/catch.hpp>

#include <cmath>

#include "glint/method.h"
#include "glint/render/ssim_formula.h"
#include "tests/support/same_bytes.h"
#include "tests/support/small_room.h"
#include "tests/support/threads.h"

using namespace glint;
using namespace glint::test;

namespace {

std::unique_ptr<Method> trained(
    const MethodSpec& spec, int iterations, std::vector<double>* losses
) {
  auto method = create_method(spec.id);
  RunOptions options;
  options.iterations = iterations;
  method->initialize(small_room(), options);
  for (int i = 0; i < iterations; ++i) {
    const StepStats stats = method->step(i);
    if (losses != nullptr) losses->push_back(stats.loss);
  }
  return method;
}

// After 60 steps on two threads, trained once for all tests that only look.
Method& after_60_steps(const MethodSpec& spec) {
  static std::map<std::string, std::unique_ptr<Method>> methods;
  auto& method = methods[spec.id];
  if (method == nullptr) method = with_threads(2, [&] { return trained(spec, 60, nullptr); });
  return *method;
}

double mean(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += values[i];
  return sum / static_cast<double>(end - begin);
}

}  // namespace

TEST_CASE("Every method's loss falls and its parameters stay finite") {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    std::vector<double> losses;
    const auto method = trained(spec, 150, &losses);
    CHECK(mean(losses, 120, 150) < 0.8 * mean(losses, 0, 15));
    CHECK_NOTHROW(method->check_finite());
    CHECK(method->num_surfels() > 0);
  }
}

TEST_CASE("Every method renders colour, depth and unit normals that face the camera") {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    const View& view = small_room().test.front();
    const MapSet out = after_60_steps(spec).render(view.camera);
    REQUIRE(out["rgb"].size() == view.camera.size());
    REQUIRE(out["rgb"].channels() == 3);
    REQUIRE(out["depth"].size() == view.camera.size());
    REQUIRE(out["normal"].size() == view.camera.size());
    REQUIRE(out["behind_expected"].size() == view.camera.size());
    REQUIRE(out["behind_median"].size() == view.camera.size());
    REQUIRE(out["first_mode"].size() == view.camera.size());
    REQUIRE(out["last_mode"].size() == view.camera.size());
    std::size_t hits = 0;
    for (int y = 0; y < view.camera.height; ++y)
      for (int x = 0; x < view.camera.width; ++x) {
        const float z = out["depth"].at(x, y);
        REQUIRE(std::isfinite(z));
        REQUIRE(out["first_mode"].at(x, y) <= out["last_mode"].at(x, y));
        const float* n = out["normal"].pixel(x, y);
        const float norm = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        CHECK((norm == 0.0f || std::abs(norm - 1) < 1e-4f));
        hits += z > 0 && norm > 0;
      }
    CHECK(hits > out["depth"].num_pixels() / 2);
  }
}

TEST_CASE("Every method renders the same bytes after saving and loading") {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    const TempFolder folder;
    Method& method = after_60_steps(spec);
    method.save(folder.path().string());
    const auto loaded = create_method(spec.id);
    loaded->load(folder.path().string());
    const Camera& camera = small_room().test.front().camera;
    const MapSet a = method.render(camera), b = loaded->render(camera);
    CHECK(same_bytes(a["rgb"], b["rgb"]));
    CHECK(same_bytes(a["depth"], b["depth"]));
    CHECK(loaded->num_surfels() == method.num_surfels());
  }
}

TEST_CASE("Every method trains to the same bytes with one and two threads") {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    const Camera& camera = small_room().test.front().camera;
    const MapSet one = with_threads(1, [&] { return trained(spec, 60, nullptr)->render(camera); });
    const MapSet two = with_threads(2, [&] { return after_60_steps(spec).render(camera); });
    CHECK(same_bytes(one["rgb"], two["rgb"]));
    CHECK(same_bytes(one["depth"], two["depth"]));
  }
}

namespace {

// The room with a left half of every training picture painted, which counts or does not: grey as
// loaders make it where a window around a pixel that counts reaches, else in `color`.
Scene half_painted(Vec3f color, bool counts) {
  constexpr int kGrey = 2 * kSsimRadius;  // windows, and gradients through them
  Scene scene = small_room();
  for (View& view : scene.train) {
    const int half = view.rgb.width() / 2;
    if (!counts) view.counted = Image(view.rgb.width(), view.rgb.height(), 1, 1.0f);
    for (int y = 0; y < view.rgb.height(); ++y)
      for (int x = 0; x < half; ++x) {
        for (int c = 0; c < 3; ++c) view.rgb.at(x, y, c) = x < half - kGrey ? color[c] : 0.5f;
        if (!counts) view.counted.at(x, y) = 0;
      }
  }
  return scene;
}

// Mean absolute difference of renders after a training with a red and a blue half.
double difference_by_paint(const std::string& method_id, bool counts) {
  RunOptions options;
  options.iterations = 30;
  Image renders[2];
  for (const int blue : {0, 1}) {
    const Scene scene = half_painted(blue != 0 ? Vec3f{0, 0, 1} : Vec3f{1, 0, 0}, counts);
    const auto method = create_method(method_id);
    method->initialize(scene, options);
    for (int i = 0; i < options.iterations; ++i) method->step(i);
    renders[blue] = method->render(scene.train.front().camera)["rgb"];
  }
  double sum = 0;
  for (std::size_t i = 0; i < renders[0].values().size(); ++i)
    sum += std::abs(static_cast<double>(renders[0].values()[i] - renders[1].values()[i]));
  return sum / static_cast<double>(renders[0].values().size());
}

}  // namespace

TEST_CASE("What a pixel shows that does not count leaves no trace in any method") {
  CHECK(difference_by_paint("2dgs", true) > 0);  // where it counts, it does
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    CHECK(difference_by_paint(id, false) == 0);
  }
}

TEST_CASE("Every method names an unknown config field and lists the known ones") {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    try {
      create_method(id, Json{{"lambda_typo", 1}});
      FAIL("accepted an unknown field");
    } catch (const Error& error) {
      CHECK(error.code() == ExitCode::kUsage);
      CHECK(std::string(error.what()).find("lambda_typo") != std::string::npos);
      CHECK(std::string(error.what()).find("known fields") != std::string::npos);
    }
  }
}

TEST_CASE("A variant differs from its method in what it overrides, and the user has the last word"
) {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    const Json config = create_method(id)->config();
    const std::size_t slash = id.find('/');
    CHECK(spec.overrides.empty() == (slash == std::string::npos));
    if (slash == std::string::npos) continue;
    CHECK(config != create_method(id.substr(0, slash))->config());
    for (const auto& entry : spec.overrides.items())
      CHECK(config.at(entry.key()) == create_method(id, spec.overrides)->config().at(entry.key()));
    CHECK(create_method(id, {{"min_opacity", 0.25}})->config().at("min_opacity") == 0.25);
  }
}

TEST_CASE("An unknown method is refused with the nearest name") {
  try {
    find_method("2dsg");
    FAIL("found a method that does not exist");
  } catch (const Error& error) {
    CHECK(std::string(error.what()).find("'2dgs'") != std::string::npos);
  }
}
