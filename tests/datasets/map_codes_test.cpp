// SPDX-License-Identifier: MIT
#include "datasets/map_codes.h"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "datasets/map_files.h"
#include "datasets/prior_maps.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{40, 30};

Image random_map(int channels, std::uint64_t seed, float low = 0, float high = 1) {
  Rng rng(seed);
  Image map(kSize.width, kSize.height, channels);
  for (float& value : map.values()) value = low + (high - low) * static_cast<float>(rng.uniform());
  return map;
}

bool same(const Image& a, const Image& b) {
  return a.size() == b.size() && a.channels() == b.channels() &&
         std::memcmp(a.data(), b.data(), a.values().size_bytes()) == 0;
}

// The number of the code that took it; its maps come back bit for bit.
int code_of(MapKind kind, const std::vector<Image>& maps) {
  std::vector<const Image*> given;
  for (const Image& map : maps) given.push_back(&map);
  const std::string coded = encode_maps(kind, given);
  std::vector<Image> found;
  for (const Image& map : maps) found.emplace_back(map.width(), map.height(), map.channels());
  std::vector<Image*> places;
  for (Image& map : found) places.push_back(&map);
  CHECK(decode_maps(coded, kind, places).empty());
  for (std::size_t i = 0; i < maps.size(); ++i) CHECK(same(found[i], maps[i]));
  return coded[0];
}

enum Code { kBit, kByte, kUnitNormals, kTwoBytes, kSixteenBits, kFixedPoint, kHalf, kFloat };

// As a loader reads what a program wrote.
Image through_file(MapKind kind, const Image& map) {
  const TempFolder folder;
  write_prior(folder / "x.png", kind, map);
  return read_prior(folder / "x.png", kind);
}

Image random_normals(std::uint64_t seed) {
  Image map = random_map(3, seed, -1, 1);
  for (std::size_t i = 0; i < map.num_pixels(); ++i) {
    float* n = map.data() + 3 * i;
    const float length = std::hypot(n[0], n[1], n[2]);
    for (int c = 0; c < 3; ++c) n[c] = i % 7 == 0 ? 0 : n[c] / length;
  }
  return map;
}

}  // namespace

TEST_CASE("photos, colours and masks take the bits of their files") {
  CHECK(code_of(MapKind::kColor, {through_file(MapKind::kColor, random_map(3, 1))}) == kByte);
  Image mask = random_map(1, 2);
  for (float& value : mask.values()) value = value > 0.5f ? 1 : 0;
  CHECK(code_of(MapKind::kMask, {mask}) == kBit);
  Image sixteen = random_map(3, 3);
  for (float& value : sixteen.values()) value = std::nearbyint(value * 65535) / 65535;
  CHECK(code_of(MapKind::kColor, {sixteen}) == kSixteenBits);
}

TEST_CASE("normals and depth of 8-bit files are kept in those bits") {
  const Image normal = through_file(MapKind::kNormal, random_normals(4));
  CHECK(code_of(MapKind::kNormal, {normal}) == kUnitNormals);
  const Image depth = through_file(MapKind::kDepth, random_map(1, 5));
  CHECK(code_of(MapKind::kDepth, {depth}) == kTwoBytes);
  // Whatever bytes a file has, among them normals far from unit length.
  const TempFolder folder;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    write_png(folder / "x.png", random_map(3, 10 + seed));
    CHECK(
        code_of(MapKind::kNormal, {read_prior(folder / "x.png", MapKind::kNormal)}) == kUnitNormals
    );
  }
}

TEST_CASE("normals whose axes a loader turned round are kept in 8 bits, too") {
  for (const PriorAxes axes : {PriorAxes::kOpengl, PriorAxes::kStableNormal}) {
    Image normal = through_file(MapKind::kNormal, random_normals(6));
    convert_prior(MapKind::kNormal, {axes, PriorDepth::kLinear}, {}, normal);
    CHECK(code_of(MapKind::kNormal, {normal}) == kUnitNormals);
  }
}

TEST_CASE("what has no smaller code is kept as floats, among them odd ones") {
  CHECK(code_of(MapKind::kColor, {random_map(3, 7)}) == kFloat);
  CHECK(code_of(MapKind::kNormal, {random_normals(8)}) == kFloat);
  Image odd = random_map(1, 9);
  odd.data()[0] = -0.0f;
  odd.data()[1] = std::numeric_limits<float>::denorm_min();
  odd.data()[2] = -std::numeric_limits<float>::max();
  odd.data()[3] = std::numeric_limits<float>::infinity();
  odd.data()[4] = std::numeric_limits<float>::quiet_NaN();
  CHECK(code_of(MapKind::kDepth, {odd}) == kFloat);
}

TEST_CASE("one map of another code takes its whole group with it") {
  Image photo = through_file(MapKind::kColor, random_map(3, 1)), other = photo;
  other.data()[5] = std::nextafter(other.data()[5], 2.0f);
  CHECK(code_of(MapKind::kColor, {photo, other}) == kFloat);
}

TEST_CASE("rounded truth is near and small") {
  Image depth = random_map(1, 1, 0.5f, 7.9f), far = random_map(1, 2, 0.5f, 15);
  depth.data()[3] = 0;
  const Image before = depth;
  round_truth(MapKind::kDepth, depth);
  round_truth(MapKind::kDepth, far);
  CHECK(code_of(MapKind::kDepth, {depth, far}) == kFixedPoint);
  CHECK(depth.data()[3] == 0);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    CHECK(std::abs(depth.data()[i] - before.data()[i]) <= 0.0625e-3f);
  Image radiance = random_map(3, 3, 0, 20);
  radiance.data()[0] = 1e6f;
  round_truth(MapKind::kPart, radiance);
  CHECK(radiance.data()[0] == 65504);
  CHECK(code_of(MapKind::kPart, {radiance}) == kHalf);
  const Image normals = random_normals(4);
  Image kept = normals;
  round_truth(MapKind::kNormal, kept);
  CHECK(same(kept, normals));
}

TEST_CASE("damaged bytes are told or give maps, and nothing else") {
  const Image photo = through_file(MapKind::kColor, random_map(3, 1));
  const Image* given[] = {&photo};
  const std::string good = encode_maps(MapKind::kColor, given);
  const auto problem = [&](const std::string& coded, MapKind kind = MapKind::kColor) {
    Image found(kSize.width, kSize.height, 3);
    Image* places[] = {&found};
    return decode_maps(coded, kind, places);
  };
  CHECK(problem(good).empty());
  CHECK(problem("") == "too few bytes");
  CHECK(problem(char(200) + good.substr(1)) == "code 200 is not known for such maps");
  CHECK(problem(char(kTwoBytes) + good.substr(1)) == "code 3 is not known for such maps");
  CHECK(problem(good.substr(0, good.size() / 2)) == "its bytes end before its maps do");
  CHECK(problem(good + "x") == "it has more bytes than its maps take");
  Rng rng(3);
  for (int round = 0; round < 300; ++round) {
    std::string bad = good;
    for (int i = 0; i < 3; ++i)
      bad[rng.below(static_cast<std::uint32_t>(bad.size()))] = static_cast<char>(rng.below(256));
    problem(bad);
  }
}

TEST_CASE("the most that bytes can hold is known before room is made") {
  const Image black(2000, 1000, 3);
  const Image* given[] = {&black};
  const std::string coded = encode_maps(MapKind::kColor, given);
  CHECK(can_hold(coded.size(), black.values().size()));
  CHECK_FALSE(can_hold(1000, std::size_t{65535} * 65535));
}
