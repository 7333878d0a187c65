// SPDX-License-Identifier: MIT
// Orders of points across surfaces, against all tuples of a small picture one by one.
#include "metrics/orders.h"

#include <catch2/catch.hpp>

#include <sstream>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "metrics/tools/orders.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

// Three surfaces of 3 x 2 pixels; the last two pixels have fewer.
const float kDepths[3][6] = {{2, 2.5f, 3, 1, 4, 2}, {3, 3.5f, 5, 2, 6, 0}, {7, 8, 9, 2.05f, 0, 0}};

Image map_of(const float* values, float scale = 1, float shift = 0) {
  Image map(3, 2, 1);
  for (std::size_t i = 0; i < 6; ++i) map.data()[i] = values[i] > 0 ? scale * values[i] + shift : 0;
  return map;
}

struct Surfaces {
  Image maps[3];
  explicit Surfaces(float scale = 1, float shift = 0)
      : maps{
            map_of(kDepths[0], scale, shift),
            map_of(kDepths[1], scale, shift),
            map_of(kDepths[2], scale, shift)} {}
  std::vector<ImageView> views() const { return {maps[0], maps[1], maps[2]}; }
  DepthAt depth() const {
    return [this](LayerPoint p) -> std::optional<float> { return maps[p.layer - 1].at(p.x, p.y); };
  }
};

}  // namespace

TEST_CASE("A tuple is in order where each point lies behind the one in front") {
  const auto depth = [](LayerPoint p) -> std::optional<float> {
    if (p.layer == 4) return std::nullopt;
    return static_cast<float>(p.x + 10 * p.layer);
  };
  CHECK(in_order({{1, 0, 1}, {2, 0, 1}, {0, 0, 2}}, depth));
  CHECK_FALSE(in_order({{2, 0, 1}, {1, 0, 1}}, depth));
  CHECK_FALSE(in_order({{2, 0, 1}, {2, 5, 1}}, depth));  // as far is not behind
  CHECK_FALSE(in_order({{0, 0, 1}, {0, 0, 4}}, depth));  // no surface there
  CHECK_FALSE(in_order({{0, 0, 1}, {1, 0, 2}}, [](LayerPoint) { return std::optional(0.0f); }));
  const std::vector<LayerTuple> tuples = {
      {{1, 0, 1}, {2, 0, 1}}, {{2, 0, 1}, {1, 0, 1}}, {{1, 0, 1}, {0, 0, 3}}};
  CHECK(percent_in_order(tuples, depth) == Approx(200.0 / 3));
  CHECK_FALSE(percent_in_order({}, depth).has_value());
}

TEST_CASE("Drawn tuples are of all points that count, in true order, apart by the margin") {
  const Surfaces truth;
  const auto surfaces = truth.views();
  MaskImage counted(3, 2, 1);
  for (std::size_t i = 1; i < 6; ++i) counted.data()[i] = 255;
  std::set<std::array<int, 3>> points;
  for (int size = 2; size <= 4; ++size)
    for (const LayerTuple& tuple : draw_tuples(surfaces, counted, size, {20000, 0.05})) {
      REQUIRE(tuple.size() == static_cast<std::size_t>(size));
      for (std::size_t k = 0; k < tuple.size(); ++k) {
        points.insert({tuple[k].x, tuple[k].y, tuple[k].layer});
        if (k > 0)
          REQUIRE(*truth.depth()(tuple[k]) >= 1.05f * *truth.depth()(tuple[k - 1]) - 1e-6f);
      }
    }
  std::set<std::array<int, 3>> expected;
  for (int layer = 1; layer <= 3; ++layer)
    for (int i = 1; i < 6; ++i)
      if (kDepths[1][i] > 0 && kDepths[layer - 1][i] > 0) expected.insert({i % 3, i / 3, layer});
  CHECK(points == expected);
  CHECK(draw_tuples(surfaces, MaskImage(3, 2, 1), 2, {}).empty());
}

TEST_CASE("Scores are those of all tuples, whatever the scale and the shift") {
  const Surfaces truth, scaled(0.25f, 3);
  const auto surfaces = truth.views();
  // A method that shows the second surface at the first one's place in half of the pixels.
  Surfaces wrong;
  for (std::size_t i = 0; i < 6; i += 2) wrong.maps[0].data()[i] = wrong.maps[1].data()[i] + 0.5f;
  for (int size = 2; size <= 4; ++size) {
    const auto tuples = draw_tuples(surfaces, {}, size, {200000, 0.05});
    CHECK(percent_in_order(tuples, truth.depth()) == 100);
    CHECK(percent_in_order(tuples, scaled.depth()) == 100);
  }
  std::size_t right = 0, all = 0;
  for (int i = 0; i < 18; ++i)
    for (int j = 0; j < 18; ++j) {
      const float a = kDepths[i / 6][i % 6], b = kDepths[j / 6][j % 6];
      const bool there = a > 0 && b > 0 && kDepths[1][i % 6] > 0 && kDepths[1][j % 6] > 0;
      if (!there || b < 1.05f * a) continue;
      ++all;
      right += wrong.maps[i / 6].data()[i % 6] < wrong.maps[j / 6].data()[j % 6];
    }
  const auto drawn = percent_in_order(draw_tuples(surfaces, {}, 2, {200000, 0.05}), wrong.depth());
  CHECK(
      *drawn == Approx(100.0 * static_cast<double>(right) / static_cast<double>(all)).margin(0.5)
  );
}

namespace {

struct Outcome {
  int code;
  std::string out, err;
};

Outcome orders(std::vector<std::string> args) {
  std::ostringstream out, err;
  const int code = run_orders_program(args, out, err);
  return {code, out.str(), err.str()};
}

}  // namespace

TEST_CASE("glint-orders scores LayeredDepth's files") {
  const test::TempFolder folder;
  const Surfaces truth(0.05f);
  for (int k = 0; k < 3; ++k)
    write_png16(folder / fmt::format("maps/7_{}.png", k + 1), truth.maps[k]);
  write_file(
      folder / "pairs/7.jsonl",
      "[[0, 0, 1], [0, 0, 2]]\n[[1, 1, 2], [2, 0, 3]]\n[[2, 0, 1], [0, 1, 1]]\n[[0, 0, 1], [9, 0, "
      "1]]\n"
  );
  write_file(folder / "trips/7.jsonl", "[[0, 1, 1], [0, 1, 2], [0, 0, 3]]\n");
  const Outcome lines = orders({folder / "maps", folder / "pairs", "--json"});
  REQUIRE(lines.code == 0);
  const Json pairs = Json::parse(lines.out)["scores"]["pairs"];
  CHECK(pairs["all"]["right"] == 2);
  CHECK(pairs["all"]["all"] == 3);  // one lies outside
  CHECK(pairs["1"]["right"] == 0);
  CHECK(pairs["mixed"]["percent"] == 100);
  CHECK_THAT(
      orders({folder / "maps", folder / "trips"}).out,
      Catch::Contains("triplets all: 100.00 % (1 of 1)")
  );

  write_file(
      folder / "own/7.json",
      R"({"layer_all": {"pairs": [{"p1": [0, 0, 1], "p2": [0, 0, 3], "is_real": true},
          {"p1": [1, 1, 3], "p2": [2, 1, 3], "is_real": false}], "trips": [], "quads": []}})"
  );
  const Outcome own = orders({folder / "maps", folder / "own", "--json"});
  CHECK(Json::parse(own.out)["scores"]["pairs"]["all"]["right"] == 2);
  // Layer 3 of the annotation is where rays enter the second time.
  const Outcome fronts = orders({folder / "maps", folder / "own", "--fronts", "--json"});
  CHECK(Json::parse(fronts.out)["scores"]["pairs"]["all"]["right"] == 1);

  const auto message = [&](const std::string& text) {
    write_file(folder / "bad/7.jsonl", text);
    const Outcome outcome = orders({folder / "maps", folder / "bad"});
    CHECK(outcome.code == 3);
    return outcome.err;
  };
  CHECK_THAT(message("[[0, 0, 1], [0, 0, 0]]"), Catch::Contains("7.jsonl: line 1"));
  CHECK_THAT(message("\n[[0, 0, 1]]"), Catch::Contains("line 2") && Catch::Contains("two to four"));
  CHECK_THAT(message("[[0, 0, 1], [0"), Catch::Contains("line 1: no JSON"));
  CHECK(orders({folder / "nothing", folder / "pairs"}).code == 2);
}
