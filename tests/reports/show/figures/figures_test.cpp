// SPDX-License-Identifier: MIT
#include "reports/show/figures/figures.h"

#include <catch2/catch.hpp>

#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "reports/show/figures/figure_methods.h"
#include "reports/show/figures/map_crops.h"
#include "reports/show/figures/map_figures.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr int kWidth = 16, kHeight = 12;

MapSet output_of(float grey, bool layered) {
  MapSet output;
  output["rgb"] = Image(kWidth, kHeight, 3, grey);
  output["depth"] = Image(kWidth, kHeight, 1, 2.0f);
  if (!layered) return output;
  for (const MapId map : {MapId("transparency"), MapId("behind_depth")})
    output[map] = Image(kWidth, kHeight, 1, 0.5f);
  for (const MapId map : {MapId("transmitted"), MapId("reflected")})
    output[map] = Image(kWidth, kHeight, 3, 0.25f);
  return output;
}

// A finished run with renders of all test views of the fake scene.
void add_run(const fs::path& folder, const std::string& method, float grey, bool layered = false) {
  Record record;
  record.dataset = "glassroom";
  record.cell = {"room_1", method, 0};
  record.metrics = {
      {"psnr", 20.0 + static_cast<double>(grey)}, {"train-minutes", 1}, {"num-surfels", 100}};
  if (layered) record.metrics.insert({{"mesh-f1@1cm", 0.2}, {"mesh-f1@5cm", 0.6}});
  append_record(folder / "records.jsonl", record);
  RunSpec spec;
  spec.folder = run_folder(folder, record.cell);
  spec.method = method;
  spec.scene = "room_1";
  write_run_spec(spec, Json::object());
  for (const View& view : fake_scene("room_1").test)
    write_render(view_folder(spec.folder, view.name), output_of(grey, layered));
}

Scene load_fake(const RunSpec&) { return fake_scene("room_1"); }

std::vector<std::string> names_of(const std::vector<fs::path>& paths) {
  std::vector<std::string> names;
  for (const fs::path& path : paths) names.push_back(path.stem().string());
  return names;
}

FigureScene scene_of(std::map<std::string, LayerMaps> methods) {
  FigureScene scene;
  scene.name = "room_1";
  scene.view = "0002";
  scene.truth = LayerMaps{{"rgb", Image(kWidth, kHeight, 3, 0.5f)}};
  for (auto& [method, maps] : methods) scene.methods[method] = std::move(maps);
  return scene;
}

}  // namespace

TEST_CASE("layers of a run are read one at a time as they are all at once") {
  const test::TempFolder folder;
  add_run(folder.path(), "glint", 0.5f, true);
  const auto view = std::make_shared<View>(fake_scene("room_1").test.front());
  const fs::path renders =
      view_folder(run_folder(folder.path(), {"room_1", "glint", 0}), view->name);
  const LayerMaps all = rendered_layers(renders, view.get());
  const FigureLayers layers(renders, view);
  REQUIRE(all.size() > 4);
  REQUIRE(all.contains("error"));
  for (const PageLayer& layer : page_layers()) {
    INFO(layer.id);
    CHECK(layers.has(layer.id) == all.contains(layer.id));
    const Image map = layers.at(layer.id);
    REQUIRE(map.empty() != all.contains(layer.id));
    if (!map.empty()) CHECK(std::ranges::equal(map.values(), all.at(layer.id).values()));
  }
  CHECK_FALSE(layers.has("nonsense"));
  write_file(renders / "depth.exr", "damaged");
  CHECK(layers.at("depth").empty());
}

TEST_CASE("figures have what the runs rendered and nothing else") {
  const test::TempFolder folder;
  add_run(folder.path(), "2dgs", 0.4f);
  CHECK(
      names_of(write_figures({folder.path(), load_fake})) ==
      std::vector<std::string>{"qualitative", "curves"}
  );
  add_run(folder.path(), "glint", 0.5f, true);
  add_run(folder.path(), "glint/no-refl", 0.3f);
  CHECK(
      names_of(write_figures({folder.path(), load_fake})) ==
      std::vector<std::string>{
          "qualitative",
          "depth_decomposition",
          "transparency",
          "radiance",
          "ablation",
          "curves",
          "f1"}
  );
  write_mesh_ply(
      run_folder(folder.path(), {"room_1", "glint", 0}) / "mesh.ply",
      {{{-9, -9, 2}, {9, -9, 2}, {0, 9, 2}}, {{0, 1, 2}}, {}}
  );
  CHECK(names_of(write_figures({folder.path(), load_fake})).back() == "meshes");
  const fs::directory_iterator files(folder / "figures");
  CHECK(std::distance(files, fs::directory_iterator()) == 2 * 8);
  for (const fs::path& png : write_figures({folder.path(), load_fake})) {
    CHECK(read_image(png, 3).width() > kMinPanelWidth);
    CHECK(read_file(fs::path(png).replace_extension(".pdf")).starts_with("%PDF-"));
  }
}

namespace {

// A log of so many steps beside a run's settings; GLINT's has sets.
void add_log(const fs::path& folder, const std::string& method, int steps) {
  RunSpec spec;
  spec.folder = folder;
  spec.method = method;
  spec.scene = "room_1";
  spec.options.iterations = steps;
  write_run_spec(spec, Json::object());
  for (int i = steps / 10; i <= steps; i += steps / 10) {
    Json line = {{"iteration", i - 1}, {"psnr", 20 + i / 1e3}, {"num_surfels", 100 + i}};
    if (method == "glint") line["sets"] = {{"interface", 90 + i}, {"transmission", 10}};
    append_line(folder / "log.jsonl", line.dump());
  }
}

}  // namespace

TEST_CASE("the figure of growth has a row for each length, and rows for sets") {
  const test::TempFolder folder;
  const auto height = [&](std::vector<std::string> methods) {
    const auto written =
        write_growth({{(folder / "runs").string()}, folder / "figures", std::move(methods), {}});
    REQUIRE(written == std::vector<fs::path>{folder / "figures/growth.png"});
    CHECK(fs::exists(folder / "figures/growth.pdf"));
    return read_image(written.front(), 3).height();
  };
  add_log(folder / "runs/a", "2dgs", 3000);
  const int one = height({});
  add_log(folder / "runs/b", "2dgs/prior", 3000);
  CHECK(height({}) == one);
  add_log(folder / "runs/c/0", "2dgs", 8000);
  const int two = height({});
  CHECK(two > one * 3 / 2);
  add_log(folder / "runs/d", "glint", 3000);
  CHECK(height({}) > two * 5 / 4);
  CHECK(height({"2dgs"}) == two);
  CHECK_THROWS_WITH(
      write_growth({{(folder / "none").string()}, folder.path(), {}, {}}),
      Catch::Contains("no such folder")
  );
  fs::create_directories(folder / "empty");
  CHECK_THROWS_WITH(
      write_growth({{(folder / "empty").string()}, folder.path(), {}, {}}),
      Catch::Contains("no run with a log")
  );
}

TEST_CASE("records and logs give a figure of growth") {
  const test::TempFolder folder;
  add_run(folder.path(), "2dgs", 0.4f);
  add_log(run_folder(folder.path(), {"room_1", "2dgs", 0}), "2dgs", 3000);
  const auto names = names_of(write_figures({folder.path(), load_fake}));
  CHECK(std::find(names.begin(), names.end(), "growth") != names.end());
}

TEST_CASE("by default pictures show methods and curves no ablations; globs choose instead") {
  const MethodChoice usual;
  CHECK(usual.in_pictures("glint"));
  CHECK_FALSE(usual.in_pictures("glint/release"));
  CHECK(usual.in_pictures("glint/plus"));
  CHECK(usual.in_pictures("ours/fast"));  // an import's name
  CHECK(usual.in_curves("glint/release"));
  CHECK_FALSE(usual.in_curves("glint/no-trans"));
  const MethodChoice chosen{{"glint/*", "2dgs"}};
  CHECK(chosen.in_pictures("glint/no-trans"));
  CHECK(chosen.in_curves("glint/no-trans"));
  CHECK(chosen.in_curves("2dgs"));
  CHECK_FALSE(chosen.in_pictures("glint"));
}

TEST_CASE("variants that render a second layer are in pictures of data that tell it apart") {
  const Image map(kWidth, kHeight, 1, 2.0f);
  const LayerMaps flat{{"depth", map}}, layered{{"depth", map}, {"layer_2_depth", map}};
  FigureScene scene =
      scene_of({{"glint", flat}, {"glint/nested", layered}, {"glint/release", flat}});
  scene.runs = {{"glint", "a"}, {"glint/nested", "b"}, {"glint/release", "c"}};
  const auto ids_of = [](const std::vector<FigureScene>& scenes) {
    std::vector<std::string> ids;
    for (const auto& [id, run] : scenes.at(0).runs) ids.push_back(id);
    return ids;
  };
  CHECK(ids_of(with_chosen_methods({scene}, {})) == std::vector<std::string>{"glint"});
  scene.truth = layered;
  const std::vector<std::string> both{"glint", "glint/nested"};
  const auto shown = with_chosen_methods({scene}, {});
  CHECK(ids_of(shown) == both);
  CHECK(shown[0].methods.size() == 2);
  CHECK(ids_of(with_chosen_methods({scene}, {{"glint"}})) == std::vector<std::string>{"glint"});
}

TEST_CASE("chosen methods alone are in pictures, whatever else was run") {
  const test::TempFolder folder;
  add_run(folder.path(), "2dgs", 0.4f);
  const auto width_of_first = [&](std::vector<std::string> methods) {
    const auto written = write_figures({folder.path(), load_fake, std::move(methods)});
    return read_image(written.front(), 3).width();
  };
  const int one = width_of_first({});
  add_run(folder.path(), "2dgs/prior", 0.3f);
  CHECK(width_of_first({}) == one);
  CHECK(width_of_first({"2dgs*"}) > one);
}

TEST_CASE("the same records give the same bytes of a figure") {
  const test::TempFolder folder;
  add_run(folder.path(), "2dgs", 0.4f);
  add_run(folder.path(), "glint", 0.5f, true);
  const auto bytes = [&] {
    std::string all;
    for (const fs::path& png : write_figures({folder.path(), load_fake}))
      all += read_file(png) + read_file(fs::path(png).replace_extension(".pdf"));
    return all;
  };
  const std::string first = bytes();
  CHECK(first.size() > 10000);
  CHECK(bytes() == first);
}

TEST_CASE("methods have titles, and one place each in all figures: variants come last") {
  CHECK(method_title("2dgs") == "2DGS");
  CHECK(method_title("2dgs/prior") == "2DGS + priors");
  CHECK(method_title("glint/no-trans") == "GLINT, w/o G_trans");
  CHECK(method_title("glint/release") == "GLINT (release)");
  CHECK(method_title("imported") == "imported");
  CHECK(method_title("imported/variant") == "imported/variant");
  std::vector<Record> records(5);
  const char* ids[] = {"glint/no-trans", "glint", "2dgs", "failed", "glint"};
  for (std::size_t i = 0; i < 5; ++i) records[i].cell = {"room_1", ids[i], 0};
  records[3].failure = Failure{};
  CHECK(figure_methods(records) == std::vector<std::string>{"2dgs", "glint", "glint/no-trans"});
}

TEST_CASE("a figure that has nothing to show any more is removed") {
  const test::TempFolder folder;
  add_run(folder.path(), "2dgs", 0.4f);
  write_file(folder / "figures/f1.png", "of earlier records");
  write_file(folder / "figures/f1.pdf", "of earlier records");
  write_figures({folder.path(), load_fake});
  CHECK_FALSE(fs::exists(folder / "figures/f1.pdf"));
  CHECK_FALSE(fs::exists(folder / "figures/f1.png"));
}

TEST_CASE("without data there are curves, without records nothing") {
  const test::TempFolder folder;
  add_run(folder.path(), "2dgs", 0.4f);
  const auto fails = [](const RunSpec&) -> Scene {
    throw Error(ExitCode::kBadReference, "the data are gone");
  };
  CHECK(names_of(write_figures({folder.path(), fails})) == std::vector<std::string>{"curves"});
  const test::TempFolder empty;
  CHECK(write_figures({empty.path(), load_fake}).empty());
}

TEST_CASE("a damaged render is missing in its panel, not an error") {
  const test::TempFolder folder;
  add_run(folder.path(), "2dgs", 0.4f);
  for (const View& view : fake_scene("room_1").test)
    write_file(
        view_folder(run_folder(folder.path(), {"room_1", "2dgs", 0}), view.name) / "depth.exr", "?"
    );
  CHECK(names_of(write_figures({folder.path(), load_fake})).front() == "qualitative");
}

TEST_CASE("the view with the most glass is shown, without glass the middle one") {
  std::vector<View> views = fake_scene("room_1").test;
  CHECK(figure_view(views) == 1);
  views[0].truth["glass"] = Image(kWidth, kHeight, 1);
  views[1].truth["glass"] = views[0].truth["glass"];
  CHECK(figure_view(views) == 1);
  views[0].truth["glass"].at(3, 3) = 1;
  CHECK(figure_view(views) == 0);
}

TEST_CASE("scene, view and crops can be chosen, and wrong ones are named") {
  const test::TempFolder folder;
  add_run(folder.path(), "2dgs", 0.4f);
  const auto records = read_records(folder.path() / "records.jsonl");
  FigureOptions options{folder.path(), load_fake};
  const std::string last = fake_scene("room_1").test.back().name;
  options.shown = {{"room_*"}, last, {"2,3,4,5"}};
  const auto scenes = figure_scenes(records, options);
  REQUIRE(scenes.size() == 1);
  CHECK(scenes[0].view == last);
  CHECK(scenes[0].crops.at(0).top == 3);
  CHECK(views_line(scenes).text == "views: " + last + " of room_1");
  const auto grid = qualitative_figure(scenes);
  CHECK(grid.legend.back().text.find("crops:") == std::string::npos);
  options.shown = {{"room_9"}};
  CHECK_THROWS_WITH(figure_scenes(records, options), "no such scene: the records are of room_1");
  options.shown = {{}, "view_x"};
  CHECK_THROWS_WITH(
      figure_scenes(records, options), Catch::StartsWith("room_1 has no test view view_x; it has ")
  );
  options.shown = {{}, "", {"10,0,7,2"}};
  CHECK_THROWS_WITH(figure_scenes(records, options), Catch::Contains("reaches out of the views"));
}

TEST_CASE("a crop is four whole numbers, and three of them fit") {
  CHECK(parse_crop("1,2,3,4", 2).height == 4);
  for (const char* wrong : {"", "1,2,3", "1,2,3,4,5", "1,2,0,4", "-1,2,3,4", "1,2,3,4x"})
    CHECK_THROWS_WITH(parse_crop(wrong, 0), Catch::Contains("expected x,y,width,height"));
  CHECK_THROWS_WITH(parse_crop("1,2,3,4", 3), Catch::Contains("at most 3"));
}

TEST_CASE("crops are where the methods together err most, on glass and off it") {
  Image first(48, 32, 1), second(48, 32, 1);
  MaskImage glass(48, 32, 1, 0);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 20; ++x) glass.at(x, y) = 255;
  first.at(40, 30) = 1;  // off glass
  first.at(1, 1) = 0.4f, second.at(18, 20) = 0.3f, second.at(17, 21) = 0.3f;
  const auto holds = [](const std::optional<Crop>& crop, int x, int y) {
    return crop && crop->left <= x && x < crop->left + 12 && crop->top <= y && y < crop->top + 8;
  };
  const auto on = crop_of_errors({&first, &second}, glass, true);
  CHECK(holds(on, 18, 20));
  CHECK(on->width == 12);
  CHECK(on->height == 8);
  CHECK(holds(crop_of_errors({&first, &second}, glass, false), 40, 30));
  CHECK(holds(crop_of_errors({&first}, glass, true), 1, 1));
  CHECK_FALSE(crop_of_errors({&first}, MaskImage(), true));
  CHECK(choose_crops({&first}, MaskImage()).size() == 1);
  CHECK(choose_crops({}, glass).empty());
}

TEST_CASE("each crop has its colour around the window and around the enlarged part") {
  const Image picture(480, 320, 3, 0.5f);
  std::vector<Crop> crops{{10, 20, 120, 80, {1, 0, 0}}, {300, 200, 120, 80, {0, 0, 1}}};
  const Image panel = outlined(picture, crops);
  CHECK(panel.at(10, 50, 0) == 1);
  CHECK(panel.at(10, 50, 2) == 0);
  CHECK(panel.at(9, 50, 0) == 0);  // black beside it
  CHECK(panel.at(350, 200, 2) == 1);
  CHECK(panel.at(70, 60, 0) == 0.5f);
  const Image parts = crop_panel(picture, crops);
  CHECK(parts.width() == panel.width());
  CHECK(parts.at(0, 0, 0) == 1);
  CHECK(parts.at(0, 0, 2) == 0);
  CHECK(parts.at(parts.width() - 1, parts.height() - 1, 2) == 1);
  CHECK(crop_panel(picture, {}).empty());
}

TEST_CASE("columns of a figure are the truth and every method, empty where one has no map") {
  const LayerMaps with_depth = {
      {"rgb", Image(kWidth, kHeight, 3)},
      {"error", Image(kWidth, kHeight, 1, 0.1f)},
      {"depth", Image(kWidth, kHeight, 1, 1.0f)}};
  const LayerMaps without = {{"rgb", Image(kWidth, kHeight, 3)}};
  const PictureGrid grid = qualitative_figure({scene_of({{"a", with_depth}, {"b", without}})});
  CHECK(grid.titles == std::vector<std::string>{"truth", "a", "b"});
  REQUIRE(grid.rows.size() == 4);  // image and depth with their crops; no normals
  CHECK(grid.row_titles[2] == "room_1\nDepth");
  CHECK(grid.rows[2][0].empty());
  CHECK_FALSE(grid.rows[2][1].empty());
  CHECK(grid.rows[2][2].empty());
  CHECK(grid.rows[1][1].size() == grid.rows[0][1].size());
}

TEST_CASE("methods of a figure stand as the rows of the summary do, others behind them by id") {
  const LayerMaps maps = {{"rgb", Image(kWidth, kHeight, 3)}};
  std::map<std::string, LayerMaps> methods;
  for (const char* id : {"a", "glint", "glint/plus", "envgs", "tsgs", "pgsr", "2dgs", "ref-gs"})
    methods[id] = maps;
  CHECK(
      qualitative_figure({scene_of(methods)}).titles ==
      std::vector<std::string>{
          "truth", "2DGS", "PGSR", "Ref-GS", "EnvGS", "TSGS", "GLINT", "a", "GLINT+"}
  );
}

TEST_CASE("the full model stands first in the ablation, variants keep the table's order") {
  const LayerMaps maps = {{"rgb", Image(kWidth, kHeight, 3)}};
  const auto scene =
      scene_of({{"glint", maps}, {"glint/no-lgeo", maps}, {"glint/no-refl", maps}, {"2dgs", maps}});
  CHECK(
      ablation_figure({scene}).titles ==
      std::vector<std::string>{"Truth", "Full model", "w/o G_refl", "w/o L_geo"}
  );
  CHECK(ablation_figure({scene_of({{"glint", maps}})}).rows.empty());
}
