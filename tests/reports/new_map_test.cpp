// SPDX-License-Identifier: MIT
// A map that is one row more of the table is in everything that lists maps.
#include <catch2/catch.hpp>

#include <algorithm>

#include "datasets/dataset.h"
#include "datasets/packed_scene.h"
#include "glint/scene/image_files.h"
#include "reports/run/bench/evaluate.h"
#include "reports/run/import/import_predictions.h"
#include "reports/run/records/run_folder.h"
#include "reports/show/figures/map_figures.h"
#include "reports/show/page/probe_values.h"
#include "reports/show/pictures/strip.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr MapRow kRow{
    "extra_depth", "Extra", MapKind::kDepth, "extra_depth.exr", "", "true_extra", "prior_extra"};
const std::string kId(kRow.id);
constexpr ImageSize kSize{32, 24};

// A dataset folder with the map as truth and prior, and a run folder in which it was rendered.
struct Fixture {
  test::TempFolder folder;
  ExtraMap extra{kRow};
  fs::path data = folder / "data", run = folder / "run";
  Scene scene;

  Fixture() {
    const std::vector<View> views = test::box_room_views(9, kSize);
    test::write_easyvolcap(data, views);
    for (const View& view : views) {
      const fs::path prior = data / "diffrens/prior_extra" / view.name / "000000.png";
      write_png(prior, Image(kSize.width, kSize.height, 1, 0.5f));
      write_truth(view, 1.0f);
    }
    scene = load_scene(data, {});
    for (const View& view : scene.test) write_render(view_folder(run, view.name), rendered(view));
  }
  void write_truth(const View& view, float scale) const {
    Image depth = view.truth["depth"];
    for (float& z : depth.values()) z *= scale;
    write_exr(data / "gt/true_extra" / (view.name + ".exr"), depth);
  }
  static MapSet rendered(const View& view) {
    MapSet maps;
    maps["rgb"] = view.rgb;
    maps["behind_depth"] = maps[kRow] = view.truth["depth"];
    return maps;
  }
};

template <class Range, class Value>
bool holds(const Range& range, const Value& value) {
  return std::find(range.begin(), range.end(), value) != range.end();
}

}  // namespace

TEST_CASE("a new map is loaded, described and packed") {
  const Fixture f;
  const View& view = f.scene.train.front();
  CHECK(view.truth[kRow].at(3, 4) == view.truth["depth"].at(3, 4));
  CHECK(view.priors[kRow].at(3, 4) == Approx(0.5).margin(0.01));
  CHECK_THAT(describe_scene(f.scene), Catch::Contains("extra_depth (2 views)"));
  CHECK_THAT(describe_scene(f.scene), Catch::Contains("extra_depth (7 views)"));
  write_packed_scene(f.folder / "scene.safetensors", f.scene);
  const Scene packed = load_scene(f.folder / "scene.safetensors", {});
  CHECK(packed.test.front().truth[kRow].at(3, 4) == f.scene.test.front().truth[kRow].at(3, 4));
  CHECK(packed.train.front().priors.has(kRow));
  LoadOptions half;
  half.size = {kSize.width / 2, kSize.height / 2};
  CHECK(load_scene(f.data, half).train.front().truth[kRow].size() == half.size);
}

TEST_CASE("a new map is looked at by the dataset check") {
  const Fixture f;
  CHECK(check_dataset(f.data).empty());
  f.write_truth(f.scene.test.front(), -1.0f);
  const auto findings = check_dataset(f.data);
  REQUIRE_FALSE(findings.empty());
  CHECK(findings.front().check == "depth-values");
  CHECK_THAT(findings.front().where, Catch::Contains("true_extra"));
}

TEST_CASE("a new map that a method renders is a file, and the scorer gets it with its truth") {
  const Fixture f;
  const View& view = f.scene.test.front();
  const fs::path folder = view_folder(f.run, view.name);
  CHECK(fs::exists(folder / "extra_depth.exr"));
  const MapSet scored = read_scored_maps(folder, kSize);
  const MaskImage no_glass;
  const ViewPair pair = view_pair(scored, view, no_glass);
  CHECK(pair.rendered[kRow].at(3, 4) == view.truth["depth"].at(3, 4));
  CHECK(pair.truth[kRow].data == view.truth[kRow].data());
  CHECK(pair.truth["rgb"].data == view.rgb.data());
}

TEST_CASE("a new map is a panel of strips, a layer of the page with values, and in figures") {
  const Fixture f;
  const auto titles = strip_titles(f.run, f.scene.test);
  CHECK(holds(titles, "Extra"));
  CHECK(holds(titles, "Extra, truth"));
  const View& view = f.scene.test.front();
  const LayerMaps maps = rendered_layers(view_folder(f.run, view.name), &view);
  CHECK(probe_values(maps, 1)[kId]["bits"] == 16);
  const Json layers = layers_json(page_layers(), {});
  CHECK(std::any_of(layers.begin(), layers.end(), [](const Json& layer) {
    return layer["id"] == kId && layer["title"] == "Extra" && layer["style"] == "depth";
  }));
  FigureScene scene;
  scene.truth = true_layers(view);
  scene.methods["method"] = maps;
  const PictureGrid grid = depth_figure({scene});
  const auto column = std::find(grid.titles.begin(), grid.titles.end(), "Extra, truth");
  REQUIRE(column != grid.titles.end());
  CHECK_FALSE(grid.rows[0][static_cast<std::size_t>(column - grid.titles.begin())].empty());
}

TEST_CASE("a new map of another program is imported") {
  const Fixture f;
  RunSpec spec;
  spec.folder = f.folder / "imported";
  import_predictions(f.run, f.scene, spec, {});
  const fs::path folder = view_folder(spec.folder, f.scene.test.front().name);
  CHECK(read_image(folder / "extra_depth.exr", 1).size() == kSize);
}
