// SPDX-License-Identifier: MIT
// The simulated priors do what their model says.
#include "datasets/glassroom/priors.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "datasets/map_files.h"
#include "glint/core/error.h"
#include "glint/scene/image_files.h"

using namespace glint;

namespace {

constexpr int kWidth = 240, kHeight = 135;

// A slanted wall; the middle half of the image is glass 1 m in front of it. Depth falls off to
// nothing in the top row.
struct Fake {
  PathTracerOutput truth;
  Image behind_albedo{kWidth, kHeight, 3, 0.4f};

  Fake() {
    const Image rgb(kWidth, kHeight, 3, 0.0f), map(kWidth, kHeight, 1, 0.0f);
    truth.maps["normal"] = truth.maps["behind_normal"] = truth.maps["albedo"] =
        truth.maps["basecolor"] = rgb;
    truth.maps["depth"] = truth.maps["behind_depth"] = map;
    truth.maps["glass"] = map;
    for (int y = 1; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) set_pixel(x, y, x > kWidth / 4 && x < 3 * kWidth / 4);
  }
  void set_pixel(int x, int y, bool glass) {
    const float z = 3 + 0.01f * static_cast<float>(x);
    truth.maps["behind_depth"].at(x, y) = z;
    truth.maps["depth"].at(x, y) = glass ? z - 1 : z;
    truth.maps["glass"].at(x, y) = glass ? 1.0f : 0.0f;
    truth.maps["normal"].at(x, y, 2) = -1;
    truth.maps["behind_normal"].at(x, y, 0) = -1;
    for (int c = 0; c < 3; ++c) {
      truth.maps["albedo"].at(x, y, c) = glass ? 0.0f : 0.4f;
      truth.maps["basecolor"].at(x, y, c) = glass ? 0.98f : 0.4f;
    }
  }
  MapSet priors(std::uint64_t view, const PriorModel& model = {}) const {
    return simulate_priors(truth, behind_albedo, model, 7, view);
  }
  bool is_glass(int x, int y) const { return truth.maps["glass"].at(x, y) != 0; }
};

bool same_bytes(const Image& a, const Image& b) {
  return a.size() == b.size() && a.values().size() == b.values().size() &&
         std::memcmp(a.data(), b.data(), a.values().size() * sizeof(float)) == 0;
}

// Shares of pixels, of several views, whose albedo is black off glass and bright on it; away from
// where blur mixes both kinds.
struct Leaks {
  double dark = 0, bright = 0;
};
Leaks leaks_of(const PriorModel& model, std::uint64_t num_views) {
  const Fake fake;
  int counts[2] = {0, 0}, totals[2] = {0, 0};
  for (std::uint64_t view = 0; view < num_views; ++view) {
    const Image albedo = fake.priors(view, model)["albedo"];
    for (int y = 10; y < kHeight - 10; y += 5)
      for (int x = 5; x < kWidth - 5; x += 5) {
        const bool glass = fake.is_glass(x, y);
        if (fake.is_glass(x - 5, y) != glass || fake.is_glass(x + 5, y) != glass) continue;
        counts[glass] += glass ? albedo.at(x, y) > 0.25f : albedo.at(x, y) < 0.45f;
        ++totals[glass];
      }
  }
  return {static_cast<double>(counts[0]) / totals[0], static_cast<double>(counts[1]) / totals[1]};
}

double angle_deg(const Image& a, const Image& b, int x, int y) {
  double d = 0;
  for (int c = 0; c < 3; ++c)
    d += static_cast<double>(a.at(x, y, c)) * static_cast<double>(b.at(x, y, c));
  return std::acos(std::clamp(d, -1.0, 1.0)) * 57.29577951;
}

}  // namespace

TEST_CASE("Normal priors are unit vectors with the stated angular error") {
  const Fake fake;
  double sum2 = 0;
  int count = 0;
  for (std::uint64_t view = 0; view < 24; ++view) {
    const Image normal = fake.priors(view)["normal"];
    for (int y = 8; y < kHeight; y += 7)
      for (int x = 4; x < kWidth / 5; x += 7, ++count) {
        sum2 += std::pow(angle_deg(normal, fake.truth.maps["normal"], x, y), 2);
        const float* n = normal.pixel(x, y);
        REQUIRE(std::hypot(n[0], n[1], n[2]) == Approx(1.0f).margin(1e-4));
      }
  }
  CHECK(std::sqrt(sum2 / count) == Approx(5).epsilon(0.15));
}

TEST_CASE("Priors see through glass at the stated rate, all maps in the same patches") {
  const Fake fake;
  int failures = 0, agree = 0, total = 0;
  for (std::uint64_t view = 0; view < 60; ++view) {
    const MapSet priors = fake.priors(view);
    for (int y = 10; y < kHeight - 10; y += 5)
      for (int x = kWidth / 4 + 8; x < 3 * kWidth / 4 - 8; x += 5, ++total) {
        const bool normal_fails = priors["normal"].at(x, y, 0) < -0.7f;
        const bool albedo_fails = priors["albedo"].at(x, y) > 0.35f;
        failures += normal_fails;
        agree += normal_fails == albedo_fails;
      }
  }
  CHECK(static_cast<double>(failures) / total == Approx(0.1).margin(0.03));
  CHECK(static_cast<double>(agree) / total > 0.97);  // they differ at blurred rims of patches
}

TEST_CASE("Glass is nearly black in the albedo prior and bright in the base colour prior") {
  const Fake fake;
  PriorModel model;
  model.failure_rate = 1e-9f;
  const MapSet priors = fake.priors(3, model);
  for (int y = 10; y < kHeight - 10; ++y)
    for (int x = kWidth / 4 + 6; x < 3 * kWidth / 4 - 6; ++x)
      for (int c = 0; c < 3; ++c) {
        REQUIRE(priors["albedo"].at(x, y, c) < 0.05f);
        REQUIRE(priors["basecolor"].at(x, y, c) > 0.6f);
      }
}

TEST_CASE("Opaque albedo priors are the sRGB encoding of the truth within the noise") {
  const Fake fake;
  const Image albedo = fake.priors(1)["albedo"];
  const float expected = srgb_encode(0.4f);
  double sum2 = 0;
  int count = 0;
  for (int y = 4; y < kHeight; ++y)
    for (int x = 0; x < kWidth / 5; ++x, ++count)
      sum2 += std::pow(static_cast<double>(albedo.at(x, y) / expected - 1), 2);
  CHECK(std::sqrt(sum2 / count) < 0.2);
  CHECK(std::sqrt(sum2 / count) > 0.01);
}

TEST_CASE("Depth priors are nearly affine in the true depth, larger is farther, 0 is invalid") {
  const Fake fake;
  for (std::uint64_t view = 0; view < 6; ++view) {
    const Image depth = fake.priors(view)["depth"];
    double sz = 0, sp = 0, szz = 0, spp = 0, szp = 0, n = 0;
    for (int y = 4; y < kHeight; ++y)
      for (int x = 0; x < kWidth / 5; ++x) {
        const double z = static_cast<double>(fake.truth.maps["depth"].at(x, y)),
                     p = static_cast<double>(depth.at(x, y));
        sz += z, sp += p, szz += z * z, spp += p * p, szp += z * p, n += 1;
      }
    const double correlation =
        (n * szp - sz * sp) / std::sqrt((n * szz - sz * sz) * (n * spp - sp * sp));
    CHECK(correlation > 0.8);
    CHECK(depth.at(10, 0) == 0.0f);
    for (int x = 0; x < kWidth; ++x) {
      REQUIRE(depth.at(x, 20) >= 0.049f);
      REQUIRE(depth.at(x, 20) <= 0.951f);
    }
  }
}

TEST_CASE("Encoded depth keeps sixteen bits through an eight-bit file") {
  Image depth(256, 1, 1);
  for (int x = 0; x < 256; ++x) depth.at(x, 0) = static_cast<float>(x) / 255.5f + 0.0007f;
  const Image encoded = encode_depth(depth);
  for (int x = 0; x < 256; ++x) {
    const auto stored = [&](int c) {
      return std::nearbyint(255.0 * static_cast<double>(encoded.at(x, 0, c))) / 255;
    };
    const double value = stored(0) + stored(1) / 256 + stored(2) / 65536;
    CHECK(value == Approx(static_cast<double>(std::min(1.0f, depth.at(x, 0)))).margin(1.2 / 65536));
  }
}

TEST_CASE("Priors are a function of seed and view") {
  const Fake fake;
  const Image a = fake.priors(2)["normal"], b = fake.priors(2)["normal"],
              c = fake.priors(3)["normal"];
  CHECK(std::equal(a.values().begin(), a.values().end(), b.values().begin()));
  CHECK_FALSE(std::equal(a.values().begin(), a.values().end(), c.values().begin()));
}

TEST_CASE("The default level is the default model, with the bytes that it has always had") {
  CHECK(config_to_json(prior_level("default")) == config_to_json(PriorModel{}));
  const Fake fake;
  const MapSet now = fake.priors(5), level = fake.priors(5, prior_level("default"));
  now.for_each([&](const MapRow& row, const Image& map) { CHECK(same_bytes(map, level[row])); });
  // Sums of what was simulated before there were levels.
  const auto sum = [&](MapId id) {
    double total = 0;
    for (const float value : now[id].values()) total += static_cast<double>(value);
    return total;
  };
  CHECK(sum("normal") == Approx(-32541.67).epsilon(1e-6));
  CHECK(sum("depth") == Approx(13649.106).epsilon(1e-6));
  CHECK(sum("albedo") == Approx(38538.364).epsilon(1e-6));
  CHECK(sum("basecolor") == Approx(72811.698).epsilon(1e-6));
}

TEST_CASE("Leaks of the albedo change nothing else") {
  const Fake fake;
  PriorModel model;
  model.dark_leak = model.bright_leak = 0.5f;
  const MapSet without = fake.priors(4), with = fake.priors(4, model);
  without.for_each([&](const MapRow& row, const Image& map) {
    INFO(row.id);
    CHECK(same_bytes(map, with[row]) == (row.id != "albedo"));
  });
}

TEST_CASE("Perfect priors are the truth but for the tones of glass and an affine depth") {
  const Fake fake;
  const MapSet priors = fake.priors(3, prior_level("perfect"));
  const Image &z = fake.truth.maps["depth"], &prior = priors["depth"];
  const auto [low, high] = [&] {
    float least = 1e9f, most = 0;
    for (const float value : z.values())
      if (value > 0) least = std::min(least, value), most = std::max(most, value);
    return std::pair(least, most);
  }();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool valid = z.at(x, y) > 0;
      const float affine = 0.05f + 0.9f * (z.at(x, y) - low) / (high - low);
      REQUIRE(prior.at(x, y) == Approx(valid ? affine : 0.0f).margin(1e-5));
      for (int c = 0; c < 3; ++c) {
        REQUIRE(
            priors["normal"].at(x, y, c) ==
            Approx(fake.truth.maps["normal"].at(x, y, c)).margin(1e-6)
        );
        for (const MapId id : {MapId("albedo"), MapId("basecolor")})
          if (!fake.is_glass(x, y))
            REQUIRE(
                priors[id].at(x, y, c) ==
                Approx(srgb_encode(fake.truth.maps[id].at(x, y, c))).margin(1e-5)
            );
      }
      if (fake.is_glass(x, y)) REQUIRE(priors["albedo"].at(x, y) < 0.04f);
    }
}

TEST_CASE("A flaw is the default with one kind of error as it is at poor") {
  const Json plain = config_to_json(prior_level("default")),
             poor = config_to_json(prior_level("poor"));
  std::vector<std::string> touched;
  for (const std::string name : kPriorFlaws) {
    const Json model = config_to_json(prior_level(name));
    for (const auto& [field, value] : model.items()) {
      INFO(name << " " << field);
      CHECK((value == plain.at(field) || value == poor.at(field)));
      if (value != plain.at(field)) touched.push_back(field);
    }
  }
  // Together they are all of poor, and no two have an error in common.
  std::sort(touched.begin(), touched.end());
  CHECK(std::adjacent_find(touched.begin(), touched.end()) == touched.end());
  CHECK(touched.size() == poor.size());
}

TEST_CASE("Flaws that are joined have the errors of each") {
  std::string all;
  for (const std::string flaw : kPriorFlaws) all += (all.empty() ? "" : "+") + flaw;
  CHECK(config_to_json(prior_level(all)) == config_to_json(prior_level("poor")));
  const PriorModel two = prior_level("dark-leak+noise");
  CHECK(two.sigma_normal_deg == prior_level("poor").sigma_normal_deg);
  CHECK(two.dark_leak == prior_level("poor").dark_leak);
  CHECK(two.failure_rate == prior_level("default").failure_rate);
  for (const std::string wrong : {"noise+", "+", "noise+poor", "poor+noise", "noise+nose", ""}) {
    INFO(wrong);
    CHECK_THROWS_WITH(prior_level(wrong), Catch::Contains("'" + wrong + "'; "));
  }
}

TEST_CASE("Levels are in order of their errors, and one that there is not is named") {
  REQUIRE(prior_levels() == std::vector<std::string>{"perfect", "good", "default", "poor", "bad"});
  Json before;
  for (const std::string& name : prior_levels()) {
    const Json model = config_to_json(prior_level(name));
    for (const auto& [field, value] : model.items()) {
      INFO(name << " " << field);
      if (!before.is_null()) CHECK(value.get<float>() >= before.at(field).get<float>());
      if (name == "perfect") CHECK(value.get<float>() == 0);
    }
    before = model;
  }
  CHECK(prior_level("good").sigma_normal_deg == 2.5f);
  CHECK(prior_level("bad").bend == 4 * PriorModel{}.bend);
  try {
    prior_level("prefect");
    FAIL("took a level that there is not");
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kUsage);
    CHECK_THAT(
        error.what(),
        Catch::Contains("priors is 'prefect'") && Catch::Contains("did you mean 'perfect'") &&
            Catch::Contains("perfect, good, default, poor, bad")
    );
  }
}

TEST_CASE("Albedo leaks at the stated rates, to black off glass and to bright on it") {
  PriorModel model;
  model.failure_rate = 0;
  const Leaks none = leaks_of(model, 2);
  CHECK(none.dark == 0);
  CHECK(none.bright == 0);
  model.dark_leak = 0.1f;
  model.bright_leak = 0.3f;
  const Leaks some = leaks_of(model, 24);
  CHECK(some.dark == Approx(0.1).margin(0.03));
  CHECK(some.bright == Approx(0.3).margin(0.05));
}

TEST_CASE("As many views are missing as the model says, spread over the path, and never all") {
  PriorModel model;
  CHECK(views_without_priors(model, 42, 7, 0).empty());
  model.missing_rate = 0.3f;
  const std::vector<int> views = views_without_priors(model, 42, 7, 0);
  CHECK(views == views_without_priors(model, 42, 7, 0));
  CHECK(views != views_without_priors(model, 42, 8, 0));
  CHECK(views != views_without_priors(model, 42, 7, 1));
  REQUIRE(views.size() == 13);
  CHECK(views.front() >= 0);
  CHECK(views.back() < 42);
  for (std::size_t i = 1; i < views.size(); ++i) {
    CHECK(views[i] > views[i - 1]);
    CHECK(views[i] - views[i - 1] <= 7);
  }
  model.missing_rate = 1;
  CHECK(views_without_priors(model, 6, 7, 0).size() == 5);
  CHECK(views_without_priors(model, 1, 7, 0).empty());
  CHECK(views_without_priors(model, 0, 7, 0).empty());
}
