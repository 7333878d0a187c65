// SPDX-License-Identifier: MIT
// What is particular to GLINT: its phases, what it is without glass, its maps.
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "glint/glint_model.h"
#include "glint/scene/ply.h"
#include "tests/support/image_difference.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kIterations = 60;

std::unique_ptr<Method> started(Json overrides, const char* id = "glint") {
  auto method = create_method(id, overrides);
  RunOptions options;
  options.iterations = kIterations;
  method->initialize(small_room(), options);
  return method;
}

SurfelCloud cloud_of(const Method& method, const char* name) {
  const TempFolder folder;
  method.save(folder.path().string());
  return read_surfel_ply(folder.path() / name);
}

// Whether an array differs between two clouds of one size.
bool same(const SurfelCloud& a, const SurfelCloud& b, const std::string& array) {
  std::vector<FloatArray> values;
  for (const SurfelCloud* cloud : {&a, &b})
    cloud->for_each_array([&](const char* name, const FloatArray& data, std::size_t) {
      if (array == name) values.push_back(data);
    });
  REQUIRE(values.size() == 2);
  return values[0] == values[1];
}

// Before and after the last 20 of 60 steps, frozen from step 40 on.
std::pair<SurfelCloud, SurfelCloud> frozen_run(const char* freeze, const char* file) {
  const auto method = started({{"freeze", freeze}, {"freeze_from", 40000}, {"densify_until", 0}});
  for (int i = 0; i < 40; ++i) method->step(i);
  const SurfelCloud before = cloud_of(*method, file);
  for (int i = 40; i < kIterations; ++i) method->step(i);
  return {before, cloud_of(*method, file)};
}

}  // namespace

TEST_CASE("A frozen interface keeps its bytes while the other sets train on") {
  const auto [before, after] = frozen_run("all", "interface.ply");
  for (const char* array : {"means", "log_scales", "rotations", "opacity_logits", "sh_dc"})
    CHECK(same(before, after, array));
  const auto [early, late] = frozen_run("all", "reflection.ply");
  CHECK_FALSE(same(early, late, "sh_dc"));
}

TEST_CASE("With frozen geometry only colour, t and s of the interface train on") {
  const auto [before, after] = frozen_run("geometry", "interface.ply");
  for (const char* array : {"means", "log_scales", "rotations", "opacity_logits"})
    CHECK(same(before, after, array));
  CHECK_FALSE(same(before, after, "sh_dc"));
  CHECK_FALSE(same(before, after, "extra_logits"));
}

TEST_CASE("Before the joint phase the secondary sets stay as they were") {
  const auto method = started({{"transmission_from", 30000}, {"reflection_from", 30000}});
  const SurfelCloud transmission = cloud_of(*method, "transmission.ply");
  const SurfelCloud reflection = cloud_of(*method, "reflection.ply");
  for (int i = 0; i < 30; ++i) method->step(i);
  CHECK(same(transmission, cloud_of(*method, "transmission.ply"), "sh_dc"));
  CHECK(same(reflection, cloud_of(*method, "reflection.ply"), "sh_dc"));
  method->step(30);
  CHECK_FALSE(same(transmission, cloud_of(*method, "transmission.ply"), "sh_dc"));
  CHECK_FALSE(same(reflection, cloud_of(*method, "reflection.ply"), "sh_dc"));
}

TEST_CASE("Transmission starts as a copy of the interface where it is asked to") {
  for (const bool clone : {false, true}) {
    const auto method = started({{"transmission_from", 30000}, {"clone_interface", clone}});
    for (int i = 0; i < 30; ++i) method->step(i);
    const SurfelCloud interface = cloud_of(*method, "interface.ply");
    method->step(30);
    const SurfelCloud transmission = cloud_of(*method, "transmission.ply");
    CHECK(transmission.extra_names.empty());
    REQUIRE(transmission.size() == interface.size());
    // One step moves a number of a quaternion by 0.001 x 1000^(1/4) at most.
    float largest = 0;
    for (std::size_t i = 0; i < interface.rotations.size(); ++i)
      largest = std::max(largest, std::abs(transmission.rotations[i] - interface.rotations[i]));
    CHECK((largest < 0.006f) == clone);
  }
}

TEST_CASE("Reflection starts as a copy of the interface where it is asked to, harmonics and all") {
  for (const bool clone : {false, true}) {
    const auto method = started({{"reflection_from", 30000}, {"clone_reflection", clone}});
    for (int i = 0; i < 30; ++i) method->step(i);
    const SurfelCloud interface = cloud_of(*method, "interface.ply");
    method->step(30);
    const SurfelCloud reflection = cloud_of(*method, "reflection.ply");
    CHECK(reflection.extra_names.empty());
    CHECK((reflection.size() == interface.size()) == clone);
    if (!clone) continue;
    double harmonics = 0;
    for (const float value : reflection.sh_rest) harmonics += std::abs(static_cast<double>(value));
    CHECK(harmonics > 0);
  }
}

TEST_CASE("A set that takes no part is not counted") {
  const std::size_t all = started(Json::object())->num_surfels();
  const auto size = [](const char* id, const char* file) {
    return cloud_of(*started(Json::object(), id), file).size();
  };
  CHECK(
      started(Json::object(), "glint/no-trans")->num_surfels() ==
      all - size("glint", "transmission.ply")
  );
  CHECK(
      started(Json::object(), "glint/no-refl")->num_surfels() ==
      all - size("glint", "reflection.ply")
  );
  const auto without = started(Json::object(), "glint/no-refl");
  CHECK(without->step(0).sets.count("reflection") == 0);
}

TEST_CASE("The oracle shows the true surface, and is no rival") {
  CHECK_FALSE(find_method("glint/oracle").rival);
  const auto method = started(Json::object(), "glint/oracle");
  for (int i = 0; i < kIterations; ++i) method->step(i);
  const View& view = small_room().test.front();
  const MapSet out = method->render_view(view);
  CHECK(largest_difference(out["depth"], view.truth["depth"]) == 0);
  CHECK(largest_difference(out["transparency"], view.truth["glass"]) == 0);
  CHECK(largest_difference(out["normal"], view.truth["normal"]) < 1e-3f);
  CHECK(method->notes().size() == 1);
  Scene without = small_room();
  for (View& train : without.train) train.truth = {};
  CHECK_THROWS_WITH(
      create_method("glint/oracle")->initialize(without, {}),
      Catch::Matchers::Contains("no true depth")
  );
}

TEST_CASE("Two views agree every so many steps of their window") {
  const auto method = started(Json::object());
  for (int i = 0; i < kIterations; ++i) {
    const bool wanted = i >= 10 && i < 21 && i % 10 == 0;
    CHECK((method->step(i).terms.count("plane") == 1) == wanted);
  }
}

TEST_CASE("Secondary sets grow by their own steps, or by those of the run") {
  // 60,000 planned steps: windows are what they say.
  for (const bool run_clock : {false, true}) {
    const auto method = create_method(
        run_clock ? "glint" : "glint/text",
        {{"transmission_from", 40},
         {"reflection_from", 1000},
         {"densify_from", 0},
         {"secondary_densify_interval", 50},
         {"transmission_gradient", 0.0}}
    );
    method->initialize(small_room(), {60000, 0});
    const std::size_t before = cloud_of(*method, "transmission.ply").size();
    int i = 0;
    const auto grows_until = [&](int end) {
      while (i < end) method->step(i++);
      return cloud_of(*method, "transmission.ply").size() > before;
    };
    CHECK_FALSE(grows_until(60));  // step 50 has statistics of ten
    CHECK(grows_until(95) == !run_clock);
    CHECK(grows_until(100));
  }
}

TEST_CASE("The three sets have the density control that the config gives them") {
  constexpr ImageSize kSmall{160, 90}, kPublished{480, 270};
  GlintConfig config;
  CHECK(config.reflection_densify(kPublished).max_scale == config.densify.max_scale);
  CHECK(config.reflection_densify(kSmall).max_scale == Approx(config.densify.max_scale * 32 / 15));
  CHECK(config.reflection_densify(kSmall).max_surfels == config.densify.max_surfels);
  const DensifyConfig interface = config.interface_densify();
  REQUIRE(interface.channel_resets.size() == 1);
  CHECK(interface.channel_resets[0].channel == kTransparency);
  CHECK(interface.channel_resets[0].ceiling == 0.01f);
  CHECK(interface.interval_at(10000) == 500);
  CHECK(interface.scale_limit == 0.1f);
  CHECK(config.transmission_densify().min_opacity == 0.05f);
  CHECK(config.reflection_densify(kSmall).min_opacity == 0.08f);
  CHECK(config.reflection_densify(kSmall).for_surfels(100000).min_surfels == 5000);
  CHECK(config.transmission_densify().for_surfels(100000).min_surfels == 1024);
  for (const DensifyConfig& set :
       {config.transmission_densify(), config.reflection_densify(kSmall)}) {
    CHECK(set.interval_at(100) == 500);
    CHECK(set.interval_at(10000) == 500);
    CHECK(set.channel_resets.empty());
    CHECK(set.scale_limit == 2);
  }
  set_text(config);
  CHECK(config.interface_densify().channel_resets.empty());
  CHECK(config.transmission_densify().min_opacity == config.densify.min_opacity);
}

TEST_CASE("In short runs, too, secondary sets have half of the resets") {
  const GlintConfig config = GlintConfig().scaled_to(3000);
  CHECK(config.interface_densify().for_views(50).reset_interval == 300);
  CHECK(config.transmission_densify().reset_interval == 600);
}

TEST_CASE("Opacities are reset as often in a short run as in the published one") {
  const auto resets = [](const GlintConfig& config, bool secondary) {
    constexpr std::size_t kViews = 64;
    const DensifyConfig set = secondary ? config.transmission_densify().for_views(kViews)
                                        : config.interface_densify().for_views(kViews);
    return set.resets ? (set.until - 1) / set.reset_interval : 0;
  };
  for (const int iterations : {8000, 30000, 60000}) {
    const GlintConfig config = GlintConfig().scaled_to(iterations);
    CHECK(resets(config, false) == 6);
    CHECK(resets(config, true) == 3);
  }
}

TEST_CASE("Rates of secondary sets count steps of the run, or their own") {
  GlintConfig config;
  CHECK(config.secondary_rates(700).first_step == 700);
  CHECK(config.secondary_rates(700).run_clock);
  config.run_clock_rates = false;
  CHECK_FALSE(config.secondary_rates(700).run_clock);
}

TEST_CASE("Without glass GLINT trains as 2DGS does") {
  // No t, no k_s, no priors, the schedules of 2DGS: the same steps, up to the unused channels.
  Json overrides(
      {{"with_transmission", false},
       {"with_reflection", false},
       {"lambda_depth", 0.0},
       {"lambda_normal", 0.0},
       {"lambda_smooth", 0.0},
       {"consistency_from", 14000},
       {"sh_interval", 2000},
       {"freeze", "nothing"},
       {"densify_from", 1000}}
  );
  // GLINT's run is shortened twice as much.
  const SurfelRates published;
  const float slower = std::pow(2.0f, -0.25f);
  overrides["rate_position"] = slower * published.means;
  overrides["rate_position_final"] = slower * published.means_final;
  overrides["rate_color"] = slower * published.sh_dc;
  overrides["rate_sh"] = slower * published.sh_rest;
  overrides["rate_scale"] = slower * published.scale;
  overrides["rate_rotation"] = slower * published.rotation;
  const auto glint = started(overrides, "glint/text");
  const auto two_dgs = create_method("2dgs");
  RunOptions options;
  options.iterations = kIterations;
  two_dgs->initialize(small_room(), options);
  for (int i = 0; i < kIterations; ++i) {
    const StepStats a = glint->step(i), b = two_dgs->step(i);
    CHECK(a.loss == Approx(b.loss).epsilon(1e-4));
  }
  const Camera& camera = small_room().test.front().camera;
  CHECK(largest_difference(glint->render(camera)["rgb"], two_dgs->render(camera)["rgb"]) < 0.02f);
}

TEST_CASE("The picture is the sum of what the maps say of it") {
  const auto method = started(Json::object());
  for (int i = 0; i < kIterations; ++i) method->step(i);
  const MapSet out = method->render(small_room().test.front().camera);
  Image sum = out["transmitted"];
  for (std::size_t i = 0; i < sum.values().size(); ++i) {
    const float t = out["transparency"].values()[i / 3];
    const float k = out["specularity"].values()[i / 3];
    sum.values()[i] +=
        (1 - k) * (1 - t) * out["interface"].values()[i] + out["reflected"].values()[i];
  }
  CHECK(largest_difference(sum, out["rgb"]) < 1e-5f);
}

TEST_CASE("In linear light the parts of the picture are in the ratio of their light") {
  const auto method = started({{"linear_light", true}});
  for (int i = 0; i < kIterations; ++i) method->step(i);
  const MapSet out = method->render(small_room().test.front().camera);
  float worst = 0;
  for (std::size_t i = 0; i < out["rgb"].values().size(); ++i) {
    const float t = out["transparency"].values()[i / 3];
    const float k = out["specularity"].values()[i / 3];
    const float picture = out["rgb"].values()[i];
    const float opaque = displayed_part(picture, out["interface"].values()[i], (1 - k) * (1 - t));
    const float sum = opaque + out["transmitted"].values()[i] + out["reflected"].values()[i];
    worst = std::max(worst, std::abs(sum - std::max(picture, 0.0f)));
  }
  CHECK(worst < 1e-4f);
}

TEST_CASE("Ablated sets leave no map behind") {
  const std::pair<const char*, MapId> ablations[] = {
      {"glint/no-trans", MapId("transmission")}, {"glint/no-refl", MapId("reflection")}};
  for (const auto& [id, map] : ablations) {
    const auto method = create_method(id);
    RunOptions options;
    options.iterations = kIterations;
    method->initialize(small_room(), options);
    for (int i = 0; i < kIterations; ++i) method->step(i);
    const MapSet out = method->render(small_room().test.front().camera);
    CHECK_FALSE(out.has(map));
  }
}

TEST_CASE("Words that GLINT does not know are refused") {
  for (const char* field : {"transmission", "freeze", "guidance"}) {
    Json overrides = Json::object();
    overrides[field] = "sideways";
    CHECK_THROWS_WITH(started(overrides), Catch::Matchers::Contains("sideways"));
  }
}

TEST_CASE("With more than one layer the transmission set has t and s of its own, and trains them") {
  const auto method = started(
      {{"layers", 2},
       {"transmission_from", 0},
       {"reflection_from", 0},
       {"initial_transparency", 0.5}}  // below 0.02 there is no light behind the interface
  );
  const SurfelCloud before = cloud_of(*method, "transmission.ply");
  CHECK(before.extra_names == std::vector<std::string>{kTransparency, kSpecular});
  for (int i = 0; i < 5; ++i) method->step(i);
  CHECK_FALSE(same(before, cloud_of(*method, "transmission.ply"), "extra_logits"));
  const TempFolder folder;
  started(Json::object())->save(folder.path().string());
  CHECK_THROWS_WITH(
      create_method("glint/nested", Json::object())->load(folder.path().string()),
      Catch::Contains("transmission.ply") && Catch::Contains("transparency, specular")
  );
  CHECK_THROWS_WITH(
      create_method("glint/nested", Json{{"transmission", "trace"}}),
      Catch::Contains("layers is 2") && Catch::Contains("needs raster")
  );
  CHECK_THROWS_WITH(create_method("glint", Json{{"layers", 5}}), Catch::Contains("at most 4"));
}
