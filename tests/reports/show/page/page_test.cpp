// SPDX-License-Identifier: MIT
// The page's data from a small store with everything that goes wrong: a torn line, renders that are
// missing or damaged, a failed cell, hostile names.
#include "reports/show/page/page.h"

#include <sys/resource.h>

#include <catch2/catch.hpp>

#include <algorithm>

#include "glint/core/process.h"
#include "glint/core/progress.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "reports/show/page/page_scenes.h"
#include "reports/show/page/page_summary.h"
#include "reports/show/pictures/depth_scale.h"
#include "reports/show/pictures/layers.h"
#include "reports/show/tables/method_title.h"
#include "tests/reports/fake_method.h"
#include "tests/support/captured.h"
#include "tests/support/count_of.h"
#include "tests/support/temp_folder.h"
#include "tests/support/told_method.h"

using namespace glint;
using glint::test::count_of;

namespace {

const std::string kHostile = "</script><img src=x onerror=alert(1)>";

Record record_of(const std::string& scene, const std::string& method) {
  Record record;
  record.profile = "test";
  record.dataset = "glassroom";
  record.cell = {scene, method, 0};
  record.metrics = {{"psnr", 20.123456789}, {"train-minutes", 0.5}};
  record.environment = {{"device", "cpu"}, {"date", "2026-01-01T00:00:00Z"}};
  return record;
}

Record failed_record() {
  Record record = record_of("room_1", "broken");
  record.metrics.clear();
  record.failure = Failure{"train", "not-finite", "loss is <b>nan</b>", {"{\"iteration\":7}"}};
  return record;
}

// A run folder of fake_scene(): config.json, scores, a log, and renders of every map.
void write_run(const fs::path& out, const Record& record) {
  RunSpec spec;
  spec.folder = run_folder(out, record.cell);
  spec.method = record.cell.method;
  spec.config = {{"grey", 0.5}};
  spec.options.iterations = 30;
  spec.dataset_folder = "data of it's own";
  spec.scene = record.cell.scene;
  write_run_spec(spec, Json::object());
  MapSet output;
  output["rgb"] = Image(16, 12, 3, 0.5f);
  output["depth"] = Image(16, 12, 1, 2.0f);
  output["transparency"] = Image(16, 12, 1, 0.25f);
  Json metrics = {{"views", Json::array()}};
  for (const View& view : fake_scene("").test) {
    write_render(view_folder(spec.folder, view.name), output);
    metrics["views"].push_back({{"name", view.name}, {"metrics", {{"psnr", 20.0}}}});
  }
  write_file(spec.folder / "metrics.json", metrics.dump());
  append_line(spec.folder / "log.jsonl", R"({"iteration":0,"loss":0.5,"psnr":9,"seconds":0.1})");
  write_file(
      spec.folder / "log.jsonl", read_file(spec.folder / "log.jsonl") + R"({"iteration":1,"lo)"
  );
}

struct Store {
  test::TempFolder folder;
  PageOptions options;

  Store() {
    set_quiet(true);
    options.folder = folder.path();
    options.profile = "test";
    options.out = "out";
    options.data = "data";
    options.load = [](const RunSpec&) { return fake_scene("room_1"); };
  }
  void add(const Record& record) const { append_record(options.folder / "records.jsonl", record); }
  void add_run(const std::string& method) const {
    add(record_of("room_1", method));
    write_run(options.folder, record_of("room_1", method));
  }
  fs::path write() const {
    const auto records = read_records(options.folder / "records.jsonl");
    std::vector<Table> tables;
    for (const TableDefinition& definition : table_definitions())
      tables.push_back(build_table(definition, records));
    return write_page(options, tables);
  }
  fs::path asset(const std::string& name) const {
    return options.folder / "report" / "assets" / name;
  }
};

// What a script assigns.
Json assigned(const fs::path& script) {
  const std::string text = read_file(script);
  const std::size_t begin = text.find("={");
  return Json::parse(text.substr(begin + 1, text.rfind(';') - begin - 1));
}
Json part(const Store& store, const std::string& name) {
  const std::string text = read_file(store.asset(name + ".js"));
  const std::size_t begin = text.find("]={");
  return Json::parse(text.substr(begin + 2, text.rfind(';') - begin - 2));
}

}  // namespace

TEST_CASE("a store becomes pictures, values, scores, curves and commands of every run") {
  const Store store;
  store.add_run("fake");
  store.write();

  const Json scene = part(store, "scene_0");
  CHECK(scene["note"] == "");
  REQUIRE(scene["views"].size() == 2);
  CHECK(scene["views"][0]["name"] == "0002");
  CHECK(scene["views"][0]["size"] == Json({16, 12}));
  CHECK(scene["views"][0]["truth"] == Json({"rgb", "depth"}));
  CHECK(scene["views"][0]["runs"][0] == Json({"rgb", "error", "depth", "transparency"}));
  CHECK(scene["metrics"] == Json({"psnr"}));
  CHECK(scene["runs"][0]["scores"] == Json::parse("[[20.0], [20.0]]"));
  CHECK(scene["runs"][0]["curve"]["loss"] == Json({0.5}));  // the torn line is left out

  CHECK(fs::exists(store.asset("pictures/s0/v0_t_rgb.png")));
  CHECK(
      read_file(store.asset("pictures/s0/v0_t_rgb.js")).find("data:image/png;base64,iVBORw0KGgo") !=
      std::string::npos
  );
  const Image error = read_image(store.asset("pictures/s0/v1_r0_error.png"), 3);
  CHECK(error.size() == ImageSize{16, 12});
  const Json probe = part(store, "probe_0_1");
  CHECK(probe["step"] == 1);
  CHECK(probe["runs"][0]["depth"]["high"] == 2.0);
  CHECK(probe["glass"].is_null());
}

TEST_CASE("commands of a run quote every word and name its settings") {
  const Store store;
  const Record record = record_of("room_1", "fake");
  write_run(store.options.folder, record);
  const std::vector<Record> records{record};
  auto scenes = page_scenes(records, store.options.folder);
  const Json commands = run_commands(scenes[0].runs[0], store.options);
  CHECK(
      commands[0]["command"] ==
      "glint-bench all --profile test --out out --data data --only room_1/fake/0 --seed 0 "
      "--force --iterations 30 --set grey=0.5"
  );
  CHECK(
      commands[1]["command"].get<std::string>().find("--dataset 'data of it'\\''s own'") !=
      std::string::npos
  );
  scenes[0].runs[0].spec->image_ratio = 0.25;
  CHECK_THAT(
      run_commands(scenes[0].runs[0], store.options)[1]["command"].get<std::string>(),
      Catch::Contains(" --image-ratio 0.25 ")
  );
}

TEST_CASE("what is missing is said and never stops the page") {
  Store store;
  for (const char* method : {"whole", "bare", "half"}) {
    store.add(record_of("room_1", method));
    if (method != std::string("bare")) write_run(store.options.folder, record_of("room_1", method));
  }
  store.add(failed_record());
  const fs::path half = store.options.folder / "runs/room_1/half/0";
  fs::remove_all(half / "renders/0002");
  write_file(half / "renders/0003/rgb.exr", "no image");
  write_file(half / "metrics.json", "[1, 2");
  write_file(half / "mesh.ply", "no mesh");
  store.write();

  const Json scene = part(store, "scene_0");
  CHECK(scene["views"][0]["runs"][1].empty());
  CHECK(scene["views"][0]["runs"][2].empty());
  CHECK(scene["views"][1]["runs"][2] == Json({"depth", "transparency"}));
  CHECK(scene["runs"][2]["scores"] == Json::parse("[null, null]"));
  CHECK(scene["runs"][2]["meshes"].empty());
  CHECK(scene["runs"][1]["curve"].is_null());
  CHECK(scene["runs"][3]["failure"] == "loss is <b>nan</b>");

  const Json summary = assigned(store.asset("data.js"));
  REQUIRE(summary["failures"].size() == 1);
  CHECK(summary["failures"][0]["cell"] == "room_1/broken/0");
  CHECK(summary["failures"][0]["log_tail"] == Json({"{\"iteration\":7}"}));
}

TEST_CASE("without the data there is no reference, and the renders are shown all the same") {
  Store store;
  store.options.load = [](const RunSpec&) -> Scene {
    throw Error(ExitCode::kBadReference, "the folder is gone");
  };
  store.add_run("fake");
  store.write();
  const Json scene = part(store, "scene_0");
  CHECK(scene["note"] == "No reference: the folder is gone");
  CHECK(scene["views"][0]["truth"].empty());
  CHECK(scene["views"][0]["size"] == Json({16, 12}));
  CHECK(scene["views"][0]["runs"][0] == Json({"rgb", "depth", "transparency"}));
  CHECK(fs::exists(store.asset("pictures/s0/v0_r0_rgb.png")));
}

TEST_CASE("a torn last record and an empty store still give a page") {
  const Store store;
  store.write();
  CHECK(assigned(store.asset("data.js"))["records"]["rows"].empty());

  store.add(record_of("room_1", "fake"));
  const fs::path file = store.options.folder / "records.jsonl";
  write_file(file, read_file(file) + R"({"scene": "room_2", "meth)");
  store.write();
  const Json records = assigned(store.asset("data.js"))["records"];
  REQUIRE(records["rows"].size() == 1);
  CHECK(records["metrics"] == Json({"psnr", "train-minutes"}));
  CHECK(
      records["rows"][0] ==
      Json({"glassroom", "room_1", "fake", 0, true, "", 0, "2026-01-01T00:00:00Z", 20.1235, 0.5})
  );
}

TEST_CASE("hostile names stay text") {
  Store store;
  store.options.profile = "profiles/a\"<b>.toml";
  const Record record = record_of("room" + kHostile, "method" + kHostile + "\xff");
  store.add(record);
  const fs::path index = store.write();
  CHECK(read_file(store.asset("data.js")).find('<') == std::string::npos);
  CHECK(read_file(store.asset("scene_0.js")).find('<') == std::string::npos);
  CHECK(read_file(index).find("<title>GLINT Bench: a&quot;&lt;b&gt;</title>") != std::string::npos);
  CHECK(
      assigned(store.asset("data.js"))["records"]["rows"][0][1].get<std::string>() ==
      "room" + kHostile
  );

  store.options.single_file = true;
  const std::string page = read_file(store.write());
  CHECK(page.find("onerror=alert(1)>") != std::string::npos);  // as text of a script
  CHECK(count_of(page, "</script") == count_of(page, "<script>"));
  CHECK(page.find("<img") == std::string::npos);
}

TEST_CASE("a single file needs nothing beside it") {
  Store store;
  store.options.single_file = true;
  store.add_run("fake");
  const std::string page = read_file(store.write());
  CHECK(!fs::exists(store.options.folder / "report" / "assets"));
  CHECK(page.find("src=\"assets") == std::string::npos);
  CHECK(
      page.find("\"pictures/s0/v0_r0_rgb.png\":\"data:image/png;base64,iVBORw0KGgo") !=
      std::string::npos
  );
  CHECK(page.find("GLINT_MESH_VIEW") != std::string::npos);
}

TEST_CASE("meshes of a page have as many faces as were asked for, fewer in a single file") {
  Store store;
  store.add_run("fake");
  TriangleMesh fan;  // in steps, so that neighbours can be merged
  for (int i = 0; i < 1000; ++i)
    fan.vertices.push_back({std::sqrt(static_cast<float>(i)), i % 2 ? 0.1f : 0.0f, 0});
  for (int i = 0; i + 2 < 1000; ++i) fan.faces.push_back({i, i + 1, i + 2});
  write_mesh_ply(store.options.folder / "runs/room_1/fake/0/mesh.ply", fan);
  store.write();
  CHECK(part(store, "mesh_0_r0a")["faces"] == 998);
  CHECK(assigned(store.asset("data.js"))["mesh_faces"] == 300'000);
  store.options.faces = 100;
  store.write();
  CHECK(part(store, "mesh_0_r0a")["faces"].get<int>() <= 100);
  CHECK(part(store, "scene_0")["runs"][0]["meshes"][0]["faces"] == 998);  // what the run has
  store.options.faces = 0;
  store.options.single_file = true;
  CHECK(mesh_faces(store.options) == 30'000);
}

TEST_CASE("a view says how much of it is glass, and methods have their titles") {
  Store store;
  store.options.load = [](const RunSpec&) {
    Scene scene = fake_scene("room_1");
    Image glass(16, 12, 1);
    for (int x = 0; x < 8; ++x) glass.at(x, 0) = 1;
    scene.test[0].truth["glass"] = glass;
    return scene;
  };
  store.add_run("fake");
  store.write();
  const Json views = part(store, "scene_0")["views"];
  CHECK(views[0]["glass"].get<double>() == Approx(8.0 / (16 * 12)).epsilon(1e-3));
  CHECK(views[1]["glass"].is_null());
  CHECK(assigned(store.asset("data.js"))["titles"] == Json({{"fake", method_title("fake")}}));
}

TEST_CASE("the page knows which methods were given the truth") {
  test::register_told_method();
  Store store;
  for (const char* method : {"fake", "told"}) store.add(record_of("room_1", method));
  store.write();
  CHECK(assigned(store.asset("data.js"))["no_rivals"] == Json({"told"}));
}

TEST_CASE("the page knows which methods its first picture shows") {
  const Store store;
  store.write();
  const Json shown = assigned(store.asset("data.js"))["main_methods"];
  CHECK(shown == Json({"2dgs", "envgs", "tsgs", "glint", "glint/plus"}));
}

TEST_CASE("a page that is written again keeps nothing of the one before") {
  const Store store;
  store.add(record_of("room_1", "fake"));
  store.write();
  write_file(store.asset("scene_7.js"), "old");
  store.write();
  CHECK(!fs::exists(store.asset("scene_7.js")));
}

TEST_CASE("what others put beside the page's files stays, and nothing of the page is taken for it"
) {
  Store store;
  store.add_run("fake");
  store.write();
  CHECK(test::captured(2, [&] { store.write(); }).empty());
  for (const char* name : {"notes.txt", "pictures/s0/mine.png", "mesh_notes.js"})
    write_file(store.asset(name), "mine");
  for (const bool single_file : {false, true}) {
    store.options.single_file = single_file;
    const std::string said = test::captured(2, [&] { store.write(); });
    for (const char* name : {"notes.txt", "pictures/s0/mine.png", "mesh_notes.js"}) {
      CHECK(read_file(store.asset(name)) == "mine");
      CHECK_THAT(said, Catch::Contains(std::string(name) + ": of no page, left as it is"));
    }
    CHECK(fs::exists(store.asset("data.js")) != single_file);
  }
}

TEST_CASE("a run that cannot be looked at is a warning, and the page shows the others") {
  Store store;
  for (const char* method : {"whole", "odd"}) store.add_run(method);
  const fs::path odd = store.options.folder / "runs/room_1/odd/0";
  for (const char* name :
       {"config.json", "metrics.json", "log.jsonl", "mesh.ply", "renders/0002/rgb.exr"}) {
    fs::remove(odd / name);
    fs::create_symlink("nowhere", odd / name);
  }
  const std::string said = test::captured(2, [&] { store.write(); });
  for (const char* name :
       {"config.json", "metrics.json", "log.jsonl", "mesh.ply", "renders/0002/rgb.exr"})
    CHECK_THAT(said, Catch::Contains(std::string("odd/0/") + name + ": is a link"));
  CHECK(part(store, "scene_0")["runs"][0]["scores"] == Json::parse("[[20.0], [20.0]]"));
}

TEST_CASE("records that cannot be read leave the page before as it was") {
  const Store store;
  store.add(record_of("room_1", "fake"));
  store.write();
  const std::string before = read_file(store.asset("data.js"));
  write_file(store.options.folder / "records.jsonl", "{\"method\": 1}\n");
  test::error_of(ExitCode::kBadPrediction, [&] { write_page(store.options, {}); });
  CHECK(read_file(store.asset("data.js")) == before);
}

TEST_CASE("depths of all methods of a scene have one range") {
  const Store store;
  Scene scene = fake_scene("room_1");
  for (View& view : scene.test) view.truth["depth"] = {};
  std::vector<fs::path> runs;
  for (const char* method : {"near", "far"}) {
    const Record record = record_of("room_1", method);
    write_run(store.options.folder, record);
    runs.push_back(run_folder(store.options.folder, record.cell));
  }
  for (const View& view : scene.test)
    write_exr(view_folder(runs[1], view.name) / "depth.exr", Image(16, 12, 1, 9.0f));
  const DepthScale scale = depth_scale(runs, scene.test);
  CHECK(scale.low == 2.0f);
  CHECK(scale.high == 9.0f);
  CHECK(!scale.from_truth);
}

TEST_CASE("the colour bar has the colours of the pictures") {
  const DepthScale scale{1, 3, true};
  for (const Json& layer : layers_json(page_layers(), scale)) {
    if (!layer.contains("colors")) continue;
    INFO(layer["id"]);
    const auto layers = page_layers();
    const auto it = std::find_if(layers.begin(), layers.end(), [&](const PageLayer& candidate) {
      return layer["id"] == candidate.id;
    });
    REQUIRE(layer["colors"].size() == 256);
    const float low = layer["low"].get<float>(), high = layer["high"].get<float>();
    for (const int step : {1, 100, 255}) {
      const Image value(1, 1, 1, low + (high - low) * static_cast<float>(step) / 255);
      std::string hex = "#";
      const Image color = layer_picture(*it, value, scale);
      for (const float channel : color.values())
        hex += fmt::format("{:02x}", static_cast<int>(std::lround(channel * 255)));
      CHECK(layer["colors"][static_cast<std::size_t>(step)] == hex);
    }
  }
}

TEST_CASE("ten thousand records give a small summary") {
  const Store store;
  std::string lines;
  for (int i = 0; i < 10'000; ++i) {
    Record record = record_of(fmt::format("room_{}", i / 100), fmt::format("method_{}", i % 100));
    for (int metric = 0; metric < 60; ++metric)
      record.metrics[fmt::format("metric-{}", metric)] = i / 7.0;
    lines += record_to_json(record).dump() + "\n";
  }
  write_file(store.options.folder / "records.jsonl", lines);
  const auto records = read_records(store.options.folder / "records.jsonl");
  const auto scenes = page_scenes(records, store.options.folder);
  CHECK(scenes.size() == 100);
  const std::string data = page_summary(store.options, {}, records, scenes).dump();
  CHECK(data.size() < 10'000'000);
}

TEST_CASE("a full disk while meshes are written is an error, not a missing mesh") {
  Store store;
  store.add_run("fake");
  Rng rng(1);  // noise does not compress
  TriangleMesh noise;
  for (int i = 0; i < 60'000; ++i)
    noise.vertices.push_back({rng.uniform(0, 1), rng.uniform(0, 1), rng.uniform(0, 1)});
  const auto any = [&] { return static_cast<std::int32_t>(rng.below(60'000)); };
  for (int i = 0; i < 100'000; ++i) noise.faces.push_back({any(), any(), any()});
  write_mesh_ply(store.options.folder / "runs/room_1/fake/0/mesh.ply", noise);
  ignore_file_size_signal();
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  const rlimit limit{700'000, old.rlim_max};  // above what the page has besides
  ::setrlimit(RLIMIT_FSIZE, &limit);
  const auto write = [&] { store.write(); };
  CHECK_THROWS_WITH(write(), Catch::Contains("mesh_0") && Catch::Contains("writing failed"));
  ::setrlimit(RLIMIT_FSIZE, &old);
  CHECK_NOTHROW(write());
}
