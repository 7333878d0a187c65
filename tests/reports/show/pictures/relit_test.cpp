// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "glint/render/transport.h"
#include "reports/show/pictures/relit.h"
#include "tests/support/image_difference.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kWidth = 7, kHeight = 5;

// Layers at random, and the picture that Eq. 5-10 makes of them.
MapSet glass_maps() {
  Rng rng(3);
  MapSet maps;
  for (const MapId id : {MapId("interface"), MapId("transmission"), MapId("reflection")})
    maps[id] = random_map(rng, {kWidth, kHeight}, 3, 0, 1);
  for (const MapId id : {MapId("transparency"), MapId("specularity")})
    maps[id] = random_map(rng, {kWidth, kHeight}, 1, 0, 1);
  Image& rgb = maps["rgb"] = Image(kWidth, kHeight, 3);
  const auto color = [&](MapId id, std::size_t i) { return get3(maps[id].data(), i); };
  for (std::size_t i = 0; i < rgb.num_pixels(); ++i)
    put3(
        rgb.data(),
        i,
        outgoing_radiance(GlassRadiance<float>{
            color("interface", i),
            color("transmission", i),
            color("reflection", i),
            maps["transparency"].data()[i],
            maps["specularity"].data()[i]})
    );
  return maps;
}

}  // namespace

TEST_CASE("without a change the picture is the rendered one") {
  const MapSet maps = glass_maps();
  CHECK(largest_difference(with_scales(maps, {}), maps["rgb"]) == 0);
  CHECK(scales_of(maps) == std::vector<std::string>{"reflection", "transmission", "transparency"});
}

TEST_CASE("scaled layers make the picture of Eq. 10") {
  const MapSet maps = glass_maps();
  const LightScales scales{0.5f, 2, 0.25f};
  const Image scaled = with_scales(maps, scales);
  for (std::size_t i = 0; i < scaled.num_pixels(); ++i) {
    const float t = 0.25f * maps["transparency"].data()[i];
    const float k = 0.5f * maps["specularity"].data()[i];
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](MapId id) { return maps[id].data()[3 * i + c]; };
      const float expected =
          (1 - k) * ((1 - t) * at("interface") + t * 2 * at("transmission")) + k * at("reflection");
      CHECK(scaled.data()[3 * i + c] == Approx(expected).margin(1e-5));
    }
  }
}

TEST_CASE("without reflection the picture keeps its brightness") {
  MapSet maps = glass_maps();
  for (const MapId id :
       {MapId("interface"), MapId("transmission"), MapId("reflection"), MapId("rgb")})
    std::fill(maps[id].values().begin(), maps[id].values().end(), 0.5f);
  const Image picture = with_scales(maps, {0, 1, 1});
  for (const float value : picture.values()) CHECK(value == Approx(0.5f));
}

TEST_CASE("shares stay below one") {
  const MapSet maps = glass_maps();
  const Image mirror = with_scales(maps, {4, 1, 1});
  for (std::size_t i = 0; i < mirror.num_pixels(); ++i)
    if (maps["specularity"].data()[i] > 0.25f)
      CHECK(mirror.data()[3 * i] == Approx(maps["reflection"].data()[3 * i]).margin(1e-5));
}

TEST_CASE("parts of the picture are scaled where there are no layers") {
  MapSet maps;
  maps["rgb"] = Image(kWidth, kHeight, 3, 0.6f);
  maps["reflected"] = Image(kWidth, kHeight, 3, 0.2f);
  CHECK(scales_of(maps) == std::vector<std::string>{"reflection"});
  CHECK(with_scales(maps, {0, 1, 1}).at(2, 2, 1) == Approx(0.4f));
  CHECK(with_scales(maps, {2, 1, 1}).at(2, 2, 1) == Approx(0.8f));
  CHECK(without_glass(maps).empty());
}

TEST_CASE("glass taken away shows what is behind it, and the picture elsewhere") {
  const MapSet maps = glass_maps();
  const Image away = without_glass(maps);
  for (std::size_t i = 0; i < away.num_pixels(); ++i) {
    const bool glass = maps["transparency"].data()[i] > 0.5f;
    const float* from = (glass ? maps["transmission"] : maps["rgb"]).data() + 3 * i;
    for (std::size_t c = 0; c < 3; ++c) CHECK(away.data()[3 * i + c] == from[c]);
  }
}
