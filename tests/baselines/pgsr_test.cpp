// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "glint/method.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("The losses of planes begin after 23 % of the run, those of two views with a neighbour") {
  Scene alone = small_room();
  alone.train.resize(1);
  for (const Scene* scene : {&small_room(), static_cast<const Scene*>(&alone)}) {
    const auto method = create_method("pgsr");
    method->initialize(*scene, {60, 0});
    for (int i = 0; i < 20; ++i) {
      const StepStats stats = method->step(i);
      INFO(scene->train.size() << " views, step " << i);
      CHECK(stats.terms.contains("plane") == (i >= 14));  // 7000 of 30,000
      CHECK(stats.terms.contains("patches") == (i >= 14 && scene->train.size() > 1));
      CHECK(stats.terms.contains("geometric") == stats.terms.contains("patches"));
    }
  }
}

TEST_CASE("Without weights of planes only the photometric loss moves surfels") {
  const auto plain = [](const Json& config) {
    const auto method = create_method("pgsr", config);
    method->initialize(small_room(), {40, 0});
    double loss = 0;
    for (int i = 0; i < 40; ++i) loss = method->step(i).terms.at("photometric");
    return loss;
  };
  const double without =
      plain({{"lambda_plane", 0.0}, {"lambda_geometric", 0.0}, {"lambda_photometric", 0.0}});
  CHECK(without == plain({{"planes_from", 60000}}));
  CHECK(without != plain(Json::object()));
}

TEST_CASE("Splitting by absolute gradients is an option that trains") {
  const auto method = create_method("pgsr", {{"max_abs_splits", 1000}});
  method->initialize(small_room(), {150, 0});
  double first = 0, last = 0;
  for (int i = 0; i < 150; ++i) {
    last = method->step(i).loss;
    if (i == 0) first = last;
  }
  CHECK(last < 0.8 * first);
  CHECK_NOTHROW(method->check_finite());
}

TEST_CASE("What few views see goes before opacities are reset, not by what a reset shows") {
  // Trimmed every 100 steps, reset at the end of the 300th, without losses of planes.
  const auto surfels_after = [](bool resets, bool trims) {
    const auto method = create_method(
        "pgsr",
        {{"opacity_resets", resets}, {"trim_until", trims ? 15000 : 0}, {"planes_from", 30000}}
    );
    method->initialize(small_room(), {3000, 0});
    for (int i = 0; i < 300; ++i) method->step(i);
    return method->num_surfels();
  };
  const std::size_t with_reset = surfels_after(true, true);
  CHECK(with_reset == surfels_after(false, true));
  CHECK(with_reset < surfels_after(true, false));
}
