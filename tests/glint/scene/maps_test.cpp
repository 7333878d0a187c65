// SPDX-License-Identifier: MIT
#include "glint/scene/maps.h"

#include <catch2/catch.hpp>

#include <set>

using namespace glint;

namespace {

constexpr MapRow kExtra{
    "extra_depth", "Extra", MapKind::kDepth, "extra_depth.exr", "", "extra", ""};

}  // namespace

TEST_CASE("ids, titles and files of the table are given once") {
  std::set<std::string_view> ids, titles, files, truths, priors;
  for (const MapRow& row : maps()) {
    CAPTURE(row.id);
    CHECK(ids.insert(row.id).second);
    CHECK(titles.insert(row.title).second);
    for (const std::string_view file : {row.file, row.picture})
      CHECK((file.empty() || files.insert(file).second));
    CHECK((row.truth.empty() || truths.insert(row.truth).second));
    CHECK((row.prior.empty() || priors.insert(row.prior).second));
    CHECK((row.file.empty() || row.file.ends_with(".exr")));
    CHECK((row.picture.empty() || row.picture.ends_with(".png")));
  }
}

TEST_CASE("a map set has what was put in, in the order of the table") {
  MapSet set;
  CHECK(set.empty());
  set["reflected"] = Image(2, 1, 3, 0.5f);
  const Image& depth = set["depth"] = Image(2, 1, 1, 4.0f);
  set["normal"] = {};
  CHECK(set["depth"].data() == depth.data());
  CHECK(set.has("reflected"));
  CHECK_FALSE(set.has("normal"));
  CHECK_FALSE(std::as_const(set).has("rgb"));
  std::vector<std::string_view> ids;
  set.for_each([&](const MapRow& row, const Image&) { ids.push_back(row.id); });
  CHECK(ids == std::vector<std::string_view>{"depth", "reflected"});
  const MapViews views = views_of(set);
  CHECK(views["depth"].data == depth.data());
  CHECK(views["normal"].empty());
}

TEST_CASE("rows are found by id, and the depth of a normal by its name") {
  CHECK(find_map("behind_depth") == &MapId("behind_depth").row());
  CHECK(find_map("no_such_map") == nullptr);
  CHECK(depth_of(MapId("normal").row())->id == "depth");
  CHECK(depth_of(MapId("behind_normal").row())->id == "behind_depth");
  CHECK(depth_of(MapId("rgb").row()) == nullptr);
  CHECK(true_map_file(MapId("glass").row(), "0007") == "glass/0007.png");
  CHECK(true_map_file(MapId("depth").row(), "0007") == "depth/0007.exr");
}

TEST_CASE("a row of a test is there as long as it lives") {
  MapSet before;
  before["rgb"] = Image(1, 1, 3);
  const std::size_t rows = maps().size();
  {
    const ExtraMap extra(kExtra);
    CHECK(maps().size() == rows + 1);
    CHECK_FALSE(before.has(kExtra));
    before[kExtra] = Image(1, 1, 1, 2.0f);
    CHECK(std::as_const(before)[*find_map("extra_depth")].at(0, 0) == 2.0f);
  }
  CHECK(find_map("extra_depth") == nullptr);
}

TEST_CASE("masks become maps of 0 and 1 and come back") {
  MaskImage mask(2, 1, 1);
  mask.at(1, 0) = 255;
  const Image map = map_of_mask(mask);
  CHECK(map.at(0, 0) == 0.0f);
  CHECK(map.at(1, 0) == 1.0f);
  CHECK(mask_of_map(map).at(1, 0) == 255);
  CHECK(mask_of_map(map).at(0, 0) == 0);
  CHECK(mask_of_map({}).empty());
}
