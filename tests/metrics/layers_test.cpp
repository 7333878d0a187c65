// SPDX-License-Identifier: MIT
// Scores by layer of eight rays with known surfaces, against plain sums over the lists of them.
#include "metrics/layers.h"

#include <catch2/catch.hpp>

#include <functional>

#include "metrics/metric.h"

using namespace glint;

namespace {

constexpr ImageSize kSize{4, 2};
enum Kind { kOpaque, kGlass, kMirror };
struct Surface {
  float z;
  Kind kind;
};
using Ray = std::vector<Surface>;  // nearest first

const std::vector<Ray> kRays = {
    {{4, kOpaque}},
    {{2, kGlass}, {5, kOpaque}},
    {{2, kGlass}, {3, kGlass}, {6, kOpaque}},
    {{1, kGlass}, {2, kGlass}, {3, kGlass}, {4, kGlass}},  // no end among the layers
    {{3, kMirror}, {7, kOpaque}},
    {{3, kMirror}, {5, kGlass}, {8, kOpaque}},
    {{2, kGlass}, {4, kMirror}, {9, kOpaque}},
    {{2, kGlass}}};  // nothing behind it

// True maps of layers up to `most`, and what a method renders of them.
struct Scored {
  std::vector<Ray> rays;
  MapSet truth, rendered;
  MaskImage glass{kSize.width, kSize.height, 1}, counted;

  explicit Scored(std::vector<Ray> of = kRays, int most = kMaxLayers) : rays(std::move(of)) {
    for (int k = 0; k < most; ++k) {
      Image& depth = truth[kLayerDepth[k]] = empty();
      Image& is_glass = truth[kLayerGlass[k]] = empty();
      Image& is_mirror = truth[kLayerMirror[k]] = empty();
      for_each(k + 1, [&](std::size_t i, const Surface& s) {
        depth.data()[i] = s.z;
        is_glass.data()[i] = s.kind == kGlass;
        is_mirror.data()[i] = s.kind == kMirror;
        if (k == 0 && s.kind == kGlass) glass.data()[i] = 255;
      });
    }
  }
  static Image empty() { return Image(kSize.width, kSize.height, 1); }
  // f(pixel, surface) of rays that have the layer.
  template <class F>
  void for_each(int layer, F&& f) const {
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (rays[i].size() >= static_cast<std::size_t>(layer))
        f(i, rays[i][static_cast<std::size_t>(layer - 1)]);
  }
  // A map with those of the layer times `factor`.
  Image times(int layer, float factor) const {
    Image map = empty();
    for_each(layer, [&](std::size_t i, const Surface& s) { map.data()[i] = factor * s.z; });
    return map;
  }
  std::map<std::string, double> scores() const {
    ViewPair pair{views_of(rendered), views_of(truth), glass, counted};
    return evaluate_view(pair);
  }
};

using Scores = std::map<std::string, double>;
std::vector<std::string> of_layers(const Scores& scores) {
  std::vector<std::string> ids;
  for (const auto& [id, value] : scores)
    if (id.starts_with("layer-") || id.starts_with("path-")) ids.push_back(id);
  return ids;
}

// By hand: the true depths that count, and what was predicted there.
struct Expected {
  double error = 0, covered = 0;
  int count = 0;
  void add(float truth, float predicted) {
    const double z = static_cast<double>(truth), p = static_cast<double>(predicted);
    error += p > 0 ? std::abs(p - z) / z : 1;
    covered += p > 0;
    ++count;
  }
  void check(const Scores& scores, const std::string& layer) const {
    INFO(layer);
    REQUIRE(count > 0);
    CHECK(scores.at("layer-" + layer + "-absrel") == Approx(error / count).epsilon(1e-6));
    CHECK(scores.at("layer-" + layer + "-coverage") == Approx(100 * covered / count));
  }
};
Expected at_layer(const Scored& scored, int layer, const Image& predicted) {
  Expected expected;
  scored.for_each(layer, [&](std::size_t i, const Surface& s) {
    if (layer > 1 || s.kind != kOpaque) expected.add(s.z, predicted.data()[i]);
  });
  return expected;
}
Expected at_last(const Scored& scored, const std::function<float(std::size_t)>& predicted) {
  Expected expected;
  for (std::size_t i = 0; i < scored.rays.size(); ++i) {
    const Ray& ray = scored.rays[i];
    if (ray.size() > 1 && ray.back().kind == kOpaque) expected.add(ray.back().z, predicted(i));
  }
  return expected;
}

}  // namespace

TEST_CASE("A method with all layers is scored by each, and at the end by its deepest of the pixel"
) {
  Scored scored;
  for (int k = 1; k <= kMaxLayers; ++k)
    scored.rendered[kLayerDepth[k - 1]] = scored.times(k, 1 + 0.1f * static_cast<float>(k));
  Image& second = scored.rendered["layer_2_depth"];
  second.at(1, 0) = 0;  // a hole in front of the wall behind the first pane
  const Scores scores = scored.scores();
  for (int k = 1; k <= kMaxLayers; ++k)
    at_layer(scored, k, scored.rendered[kLayerDepth[k - 1]]).check(scores, std::to_string(k));
  CHECK(scores.at("layer-1-absrel") == Approx(0.1).epsilon(1e-6));
  CHECK(scores.at("layer-2-absrel") == Approx((1 + 5 * 0.2) / 6).epsilon(1e-6));
  CHECK(scores.at("layer-4-absrel") == Approx(0.4).epsilon(1e-6));
  CHECK(scores.at("layer-2-coverage") == Approx(100 * 5 / 6.0));
  // Rays 1, 2, 4, 5, 6 end; the first of them at the method's pane, as it has a hole behind.
  const double hole = std::abs(1.1 * 2 - 5) / 5;
  CHECK(scores.at("layer-last-absrel") == Approx((hole + 3 * 0.3 + 0.2) / 5).epsilon(1e-6));
  CHECK(scores.at("layer-last-coverage") == 100);
}

TEST_CASE("A method with fewer layers than the truth is scored by its deepest one") {
  Scored scored;
  scored.rendered["depth"] = scored.times(1, 1.1f);
  const Image second = scored.times(2, 0.9f);
  const auto check = [&](const std::function<float(std::size_t)>& last) {
    const Scores scores = scored.scores();
    for (int k = 2; k <= kMaxLayers; ++k)
      at_layer(scored, k, second).check(scores, std::to_string(k));
    at_layer(scored, 1, scored.rendered["depth"]).check(scores, "1");
    at_last(scored, last).check(scores, "last");
  };
  scored.rendered["layer_2_depth"] = second;
  check([&](std::size_t i) {
    const float deepest = second.data()[i];
    return deepest > 0 ? deepest : scored.rendered["depth"].data()[i];
  });
  // With layers of its own, what it calls the depth behind does not count; without, it is all.
  scored.rendered["behind_depth"] = Image(kSize.width, kSize.height, 1, 100.0f);
  CHECK(scored.scores().at("layer-2-absrel") < 1);
  scored.rendered["layer_2_depth"] = {};
  scored.rendered["behind_depth"] = second;
  check([&](std::size_t i) { return second.data()[i]; });
}

TEST_CASE("A method with one layer is scored at the first and at the end") {
  Scored scored;
  scored.rendered["depth"] = scored.times(1, 1.1f);
  const Scores scores = scored.scores();
  at_last(scored, [&](std::size_t i) {
    return scored.rendered["depth"].data()[i];
  }).check(scores, "last");
  const std::vector<std::string> ids = {
      "layer-1-absrel", "layer-1-coverage", "layer-last-absrel", "layer-last-coverage"};
  CHECK(of_layers(scores) == ids);
}

TEST_CASE("A method with more layers than the truth is scored at the true ones, and by its deepest"
) {
  const std::vector<Ray> rays(8, Ray{{2, kGlass}, {5, kOpaque}});
  Scored scored(rays, 2);
  scored.rendered["depth"] = scored.times(1, 1);
  scored.rendered["layer_2_depth"] = scored.times(2, 1);
  scored.rendered["layer_3_depth"] = Scored::empty();
  scored.rendered["layer_3_depth"].at(2, 1) = 6;
  const Scores scores = scored.scores();
  CHECK(scores.at("layer-1-absrel") == 0);
  CHECK(scores.at("layer-2-absrel") == 0);
  CHECK(scores.at("layer-last-absrel") == Approx(0.2 / 8).epsilon(1e-6));
  CHECK_FALSE(scores.contains("layer-3-absrel"));
  // Told apart, but none is so deep: nothing to score, either.
  Scored all(rays);
  all.rendered = scored.rendered;
  CHECK(of_layers(all.scores()) == of_layers(scores));
}

TEST_CASE("Where there is no glass and no mirror, or no truth of layers, there are no such scores"
) {
  Scored opaque(std::vector<Ray>(8, Ray{{4, kOpaque}}));
  Scored first_only(kRays, 1);
  for (Scored* scored : {&opaque, &first_only}) {
    for (const MapId id : kLayerDepth) scored->rendered[id] = scored->times(1, 1);
    for (const MapId id : kLayerTransparency) scored->rendered[id] = Scored::empty();
    for (const MapId id : kLayerNormal)
      scored->rendered[id] = scored->truth[id] = Image(kSize.width, kSize.height, 3, 0.57735f);
    if (scored == &first_only) scored->truth["layer_2_normal"] = {};
    CHECK(of_layers(scored->scores()).empty());
  }
}

TEST_CASE("Behind a mirror, layers are scored where they appear, but are not behind glass for it") {
  Scored scored(std::vector<Ray>(8, Ray{{3, kMirror}, {5, kGlass}, {8, kOpaque}}));
  for (int k = 1; k <= 3; ++k) {
    scored.rendered[kLayerDepth[k - 1]] = scored.times(k, 1.25f);
    scored.rendered[kLayerTransparency[k - 1]] = Image(kSize.width, kSize.height, 1, 0.9f);
  }
  const Scores scores = scored.scores();
  for (const char* layer : {"1", "2", "3", "last"}) {
    CHECK(scores.at(fmt::format("layer-{}-absrel", layer)) == Approx(0.25));
    CHECK_FALSE(scores.contains(fmt::format("layer-{}-t-iou", layer)));
  }
}

TEST_CASE("Whether a layer is glass is scored among the pixels with such a layer behind glass") {
  Scored scored;
  for (const MapId id : kLayerTransparency) scored.rendered[id] = Scored::empty();
  const std::vector<std::vector<std::size_t>> called = {{0, 1, 2, 4}, {0, 1, 2, 5}, {3, 5, 6}};
  for (std::size_t k = 0; k < called.size(); ++k)
    for (const std::size_t i : called[k])
      scored.rendered[kLayerTransparency[k]].data()[i] = i == 2 ? 1 : 0.75f;
  const Scores scores = scored.scores();
  // Glass first: rays 1, 2, 3, 6, 7, of which 1 and 2 are called so, and 0 and 4 wrongly.
  CHECK(scores.at("layer-1-t-iou") == Approx(2 / 7.0));
  CHECK(scores.at("layer-1-t-iou") == scores.at("transparency-iou"));
  // Second layers behind glass: rays 1, 2, 3, 6; glass in 2 and 3; called in 1 and 2.
  CHECK(scores.at("layer-2-t-iou") == Approx(1 / 3.0));
  // Third layers: rays 2, 3, 5, 6; glass in 3; called in 3, 5 and 6.
  CHECK(scores.at("layer-3-t-iou") == Approx(1 / 3.0));
  CHECK_FALSE(scores.contains("layer-4-t-iou"));
}

TEST_CASE("Normals of a layer are scored where a method renders them") {
  Scored scored;
  const float sine = 0.6f, cosine = 0.8f;
  for (int k = 1; k <= 3; ++k) {
    Image& truth = scored.truth[kLayerNormal[k - 1]] = Image(kSize.width, kSize.height, 3);
    scored.for_each(k, [&](std::size_t i, const Surface&) { truth.data()[3 * i + 2] = -1; });
  }
  Image& second = scored.rendered["layer_2_normal"] = Image(kSize.width, kSize.height, 3);
  for (std::size_t i = 0; i < kRays.size(); ++i) {
    if (i == 6) continue;  // a hole: 90 degrees
    second.data()[3 * i + (i == 1 ? 0 : 1)] = sine;
    second.data()[3 * i + 2] = -cosine;
  }
  const Scores scores = scored.scores();
  const double angle = std::atan2(0.6, 0.8) * 180 / 3.14159265358979;
  CHECK(scores.at("layer-2-mae") == Approx((5 * angle + 90) / 6).epsilon(1e-6));
  CHECK(of_layers(scores) == std::vector<std::string>{"layer-2-mae"});
}

TEST_CASE("Pixels that do not count are in no layer") {
  Scored scored;
  scored.counted = MaskImage(kSize.width, kSize.height, 1, 255);
  scored.counted.at(1, 0) = 0;
  scored.rendered["depth"] = scored.times(1, 1);
  scored.rendered["layer_2_depth"] = scored.times(2, 1.5f);
  scored.rendered["layer_2_depth"].at(1, 0) = 0;
  const Scores scores = scored.scores();
  CHECK(scores.at("layer-2-absrel") == Approx(0.5).epsilon(1e-6));
  CHECK(scores.at("layer-2-coverage") == 100);
}

TEST_CASE("What came by each path is compared with its share of the pixel, at panes and mirrors") {
  Scored scored;
  const char* paths[] = {"path_t", "path_tt", "path_r", "path_tr", "path_rt", "path_rest"};
  const auto set = [&](const char* id, MapSet& maps, float value) {
    maps[*find_map(id)] = Image(kSize.width, kSize.height, 3, value);
  };
  set("rgb", scored.truth, 0.8f);
  for (int p = 0; p < 6; ++p) set(paths[p], scored.truth, static_cast<float>(p + 1));
  for (int p = 0; p < 3; ++p) {
    set(paths[p], scored.rendered, 0.1f);
    scored.rendered[*find_map(paths[p])].at(0, 0, 1) = 1;  // neither glass nor mirror
  }
  // Brighter in the mirror of ray 4: by paths T and R alike.
  scored.truth["path_t"].at(0, 1, 0) = 13;
  const auto error = [](double predicted, double part, double sum) {
    return std::pow(predicted - 0.8 * part / sum, 2);
  };
  const Scores scores = scored.scores();
  for (int p = 0; p < 3; ++p) {
    const double part = p + 1;
    double sum = 20 * error(0.1, part, 21);  // 7 pixels of 3 channels, one of them as above
    sum += error(0.1, p == 0 ? 13 : part, 33);
    const std::string id = fmt::format("path-{}-psnr", p == 0 ? "t" : p == 1 ? "tt" : "r");
    CHECK(scores.at(id) == Approx(-10 * std::log10(sum / 21)).epsilon(1e-5));
  }
  CHECK(
      of_layers(scores) == std::vector<std::string>{"path-r-psnr", "path-t-psnr", "path-tt-psnr"}
  );
  scored.truth["path_rest"] = {};  // the shares are not known
  CHECK(of_layers(scored.scores()).empty());
}
