// SPDX-License-Identifier: MIT
// What is particular to EnvGS: when what helps its environment along acts.
#include <catch2/catch.hpp>

#include "glint/scene/ply.h"
#include "glint/train/trainer.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kPlanned = 400, kRun = 120;

struct Run {
  std::unique_ptr<Method> method;
  std::vector<double> losses;
};
// The simplified method with these pieces of the full one.
Run run(Json pieces) {
  // So early that short runs see them; nothing grows.
  Json overrides = {
      {"bootstrap_from", 0},
      {"densify_until", 0},
      {"environment_from", 1000},
      {"environment_densify_until", 0}};
  overrides.update(pieces);
  Run result{create_method("envgs/simple", overrides), {}};
  result.method->initialize(small_room(), {kPlanned, 0});
  for (int i = 0; i < kRun; ++i) result.losses.push_back(result.method->step(i).loss);
  return result;
}

SurfelCloud saved_set(const Method& method, const char* file) {
  const TempFolder folder;
  method.save(folder.path().string());
  return read_surfel_ply(folder.path() / file);
}
SurfelCloud base_of(const Run& run) { return saved_set(*run.method, "interface.ply"); }
SurfelCloud environment_of(const Method& method) { return saved_set(method, "reflection.ply"); }

float largest(const FloatArray& values) { return *std::max_element(values.begin(), values.end()); }

}  // namespace

TEST_CASE("Colour sabotage and normal propagation act after 100 steps and not before") {
  const Run simple = run(Json::object());
  const Run sabotaged = run({{"color_sabotage", true}});
  const Run propagated = run({{"normal_propagation", true}, {"propagation_opacity", 0.999}});
  for (const Run* other : {&sabotaged, &propagated}) {
    for (int i = 0; i < 100; ++i) CHECK(other->losses[i] == simple.losses[i]);
    CHECK(other->losses[100] > simple.losses[100]);
  }
  const FloatArray opacities = base_of(propagated).opacity_logits;
  CHECK(*std::min_element(opacities.begin(), opacities.end()) > 5);
}

TEST_CASE("The environment grows by statistics of a whole interval") {
  // 40,000 planned steps: windows are what they say.
  const Json early = {
      {"environment_from", 40},
      {"environment_densify_from", 0},
      {"environment_densify_interval", 50},
      {"environment_gradient", 0.0}};
  const auto method = create_method("envgs", early);
  method->initialize(small_room(), {40000, 0});
  const std::size_t before = environment_of(*method).size();
  int i = 0;
  const auto grows_until = [&](int end) {
    while (i < end) method->step(i++);
    return environment_of(*method).size() > before;
  };
  CHECK_FALSE(grows_until(95));  // step 50 has statistics of ten
  CHECK(grows_until(100));
}

TEST_CASE("The specularity returns to its initial value with the second reset of opacities") {
  const Json often = {{"densify_until", 40000}, {"densify_from", 39000}, {"prune_holiday", 0}};
  for (const bool reset : {false, true}) {
    Json pieces = often;
    pieces["reset_specular"] = reset;
    pieces["rate_specular"] = 1;
    Json overrides = pieces;
    auto method = create_method("envgs/simple", overrides);
    method->initialize(small_room(), {700, 0});
    for (int i = 0; i < 600; ++i) method->step(i);  // its first reset is the second of opacities
    const Run finished{std::move(method), {}};
    const float initial = std::log(0.001f / 0.999f);
    CHECK((largest(base_of(finished).extra_logits) <= initial + 1e-5f) == reset);
  }
}

TEST_CASE("The simplified method has none of the pieces, the full one all") {
  const Json full = create_method("envgs")->config(),
             simple = create_method("envgs/simple")->config();
  for (const char* piece :
       {"color_sabotage",
        "normal_propagation",
        "reset_specular",
        "reset_environment",
        "split_large",
        "cap_by_visibility",
        "near_consistency"}) {
    INFO(piece);
    CHECK(full.at(piece) == true);
    CHECK(simple.at(piece) == false);
  }
  CHECK(full.at("densify_slow_interval") == 500);
  CHECK(simple.at("densify_slow_interval") == 0);
}
