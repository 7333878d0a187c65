// SPDX-License-Identifier: MIT
// Every registered method on scenes that lack something: a run that makes sense and says what it
// did without, or a clear error.
#include <catch2/catch.hpp>

#include "glint/method.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

std::vector<std::string> warnings_of_short_run(const MethodSpec& spec, const Scene& scene) {
  const auto method = create_method(spec.id);
  RunOptions options;
  options.iterations = 16;  // schedules scale: every phase is in it
  method->initialize(scene, options);
  for (int i = 0; i < options.iterations; ++i) {
    const StepStats stats = method->step(i);
    CHECK(std::isfinite(stats.loss));
  }
  CHECK_NOTHROW(method->check_finite());
  CHECK(method->num_surfels() > 0);
  const MapSet out = method->render_view(scene.test.front());
  for (const MapId id : {MapId("rgb"), MapId("depth"), MapId("normal")})
    for (const float value : out[id].values()) REQUIRE(std::isfinite(value));
  return method->warnings();
}

bool any_says(const std::vector<std::string>& warnings, const std::string& text) {
  for (const std::string& warning : warnings)
    if (warning.find(text) != std::string::npos) return true;
  return false;
}

template <class Body>
void for_every_method(Body&& body) {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    body(spec);
  }
}

// Whether a method's config weighs this prior.
bool uses(const MethodSpec& spec, const char* weight) {
  const Json config = create_method(spec.id)->config();
  return config.contains(weight) && config.at(weight).get<double>() > 0;
}

}  // namespace

TEST_CASE("Without points every method starts from random ones, and says so") {
  Scene scene = small_room();
  scene.points = {};
  for_every_method([&](const MethodSpec& spec) {
    CHECK(any_says(warnings_of_short_run(spec, scene), "has no points"));
  });
}

TEST_CASE("Without priors every method trains, and names each loss that is off") {
  Scene scene = small_room();
  for (View& view : scene.train) view.priors = {};
  for_every_method([&](const MethodSpec& spec) {
    const auto warnings = warnings_of_short_run(spec, scene);
    CHECK(any_says(warnings, "L_depth is off") == uses(spec, "lambda_depth"));
    CHECK(any_says(warnings, "L_normal is off") == uses(spec, "lambda_normal"));
  });
}

TEST_CASE("Where LPIPS is wanted and has no weights, the record says that it is off") {
  ::setenv("GLINT_LPIPS_WEIGHTS", "/no/such/folder", 1);
  for_every_method([&](const MethodSpec& spec) {
    const bool wanted = uses(spec, "lambda_lpips");
    const auto warnings = warnings_of_short_run(spec, small_room());
    CHECK(any_says(warnings, "LPIPS is off") == wanted);
    if (!wanted) return;
    const auto without = create_method(spec.id, Json{{"lambda_lpips", 0.0}});
    without->initialize(small_room(), {});
    CHECK_FALSE(any_says(without->warnings(), "LPIPS"));
  });
}

TEST_CASE("Where some views have no priors every method trains, and the warning counts them") {
  Scene scene = small_room();
  for (std::size_t i = 0; i < scene.train.size(); i += 2) scene.train[i].priors = {};
  const std::size_t missing = (scene.train.size() + 1) / 2;
  for_every_method([&](const MethodSpec& spec) {
    const auto warnings = warnings_of_short_run(spec, scene);
    for (const auto& [weight, prior] :
         {std::pair("lambda_depth", "depth"), std::pair("lambda_normal", "normal")})
      CHECK(
          any_says(warnings, fmt::format("no {} prior for {} of ", prior, missing)) ==
          uses(spec, weight)
      );
  });
}

TEST_CASE("Without glass every method trains") {
  Scene scene = small_room();
  for (View& view : scene.train) {
    for (float& value : view.priors["albedo"].values()) value = 0.5f;
    view.truth["glass"] = {};
  }
  for_every_method([&](const MethodSpec& spec) {
    if (!spec.rival) return;  // is given the true glass, or does not begin
    warnings_of_short_run(spec, scene);
  });
}

TEST_CASE("With glass everywhere every method trains") {
  Scene scene = small_room();
  for (std::vector<View>* views : {&scene.train, &scene.test})
    for (View& view : *views)
      view.truth["glass"] = Image(view.camera.width, view.camera.height, 1, 1.0f);
  for_every_method([&](const MethodSpec& spec) { warnings_of_short_run(spec, scene); });
}

TEST_CASE("One training view is enough for every method, and losses of two views are off") {
  Scene scene = small_room();
  scene.train.resize(1);
  set_extent(scene);
  for_every_method([&](const MethodSpec& spec) {
    const auto warnings = warnings_of_short_run(spec, scene);
    const bool wanted = uses(spec, "lambda_geometric") || uses(spec, "lambda_multi_view");
    CHECK(any_says(warnings, "1 of 1 training views without a neighbour") == wanted);
  });
}

// Close together, 25 degrees apart, each sees 10.
TEST_CASE("Neighbours that see nothing in common are no trouble to any method") {
  Scene scene = small_room();
  scene.train.resize(1);
  scene.train[0].camera.fx = scene.train[0].camera.fy = 6.0 * scene.train[0].camera.width;
  scene.train.push_back(scene.train[0]);
  Camera& other = scene.train[1].camera;
  const double half = 12.5 * M_PI / 180;
  const Mat3d turn = rotation_from_quaternion({std::cos(half), 0, std::sin(half), 0});
  other.rotation_cam_from_world = turn * other.rotation_cam_from_world;
  other.translation_cam_from_world = turn * other.translation_cam_from_world + Vec3d{0.3, 0, 0};
  set_extent(scene);
  for_every_method([&](const MethodSpec& spec) { warnings_of_short_run(spec, scene); });
}

TEST_CASE("Points behind all cameras are an error that names what to look at") {
  Scene scene = small_room();
  for (Vec3f& point : scene.points.positions) point = {1e3f, 1e3f, -1e3f};
  for (View& view : scene.train)
    view.camera = look_at({0, 0, 0}, {-1, -1, 1}, {0, 0, 1}, view.camera.size(), 60);
  for_every_method([&](const MethodSpec& spec) {
    try {
      create_method(spec.id)->initialize(scene, {});
      FAIL("accepted points that no camera sees");
    } catch (const Error& error) {
      CHECK(error.code() == ExitCode::kBadReference);
      CHECK(std::string(error.what()).find("in front of any") != std::string::npos);
    }
  });
}
