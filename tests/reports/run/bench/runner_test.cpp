// SPDX-License-Identifier: MIT
#include "reports/run/bench/runner.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "glint/core/file_lock.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "reports/run/bench/cell_stages.h"
#include "reports/run/bench/stages.h"
#include "reports/verbs/result_tables.h"
#include "tests/reports/fake_method.h"
#include "tests/reports/run/bench/one_cell.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using test::OneCell;

namespace {

[[maybe_unused]] const bool quiet = (set_quiet(true), true);

}  // namespace

TEST_CASE("every cell of a profile is trained, rendered, scored and recorded") {
  const test::TempFolder folder;
  const RunSummary summary = run_profile(fake_run(folder.path()));
  CHECK(summary.ran == 4);
  CHECK(summary.failed == 0);
  const auto records = read_records(folder.path() / "records.jsonl");
  REQUIRE(records.size() == 4);
  // Grey 0.5 against 0.6: PSNR is 20 dB up to float rounding; depth 2 against 2.5.
  CHECK(records[0].metrics.at("psnr") == Approx(20.0).epsilon(1e-6));
  CHECK(records[0].metrics.at("depth-absrel") == Approx(0.2).epsilon(1e-12));
  CHECK(records[0].metrics.at("num-surfels") == 7);
  CHECK(records[0].metrics.at("fps") > 0);
  CHECK(records[0].resolution == "16x12");
  CHECK(records[0].notes == std::vector<std::string>{"a fake"});
  const auto& absent = records[0].not_applicable;
  CHECK(std::count(absent.begin(), absent.end(), "transparency-iou") == 1);
  CHECK(std::count(absent.begin(), absent.end(), "psnr") == 0);
  for (const char* mesh : {"mesh-cd", "mesh-f1@5cm-p2p", "behind-mesh-cd"})  // no true mesh
    CHECK(std::count(absent.begin(), absent.end(), mesh) == 1);
  CHECK(records[0].environment.at("device") == "cpu");
}

TEST_CASE("a cell that another process is at is left to it, and done when it is free") {
  const test::TempFolder folder;
  const RunnerOptions options = fake_run(folder.path());
  {
    const auto lock =
        FileLock::take(FileLock::file_beside(folder.path() / "runs/room_1/fake/other/0"));
    REQUIRE(std::holds_alternative<FileLock>(lock));
    const RunSummary summary = run_profile(options);
    CHECK(summary.ran == 3);
    CHECK(summary.elsewhere == 1);
    CHECK(read_records(folder.path() / "records.jsonl").size() == 3);
  }
  const RunSummary summary = run_profile(options);
  CHECK(summary.ran == 1);
  CHECK(summary.reused == 3);
  CHECK(summary.elsewhere == 0);
}

TEST_CASE("what another process finished meanwhile is reused") {
  const test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  options.filter.only = {"room_1/fake/*"};
  bool first = true;
  options.load = [&](const SceneSource& source) {
    if (std::exchange(first, false)) {  // the other one, while this one loads its first scene
      RunnerOptions other = fake_run(folder.path());
      other.filter.only = {"room_1/fake/other/0"};
      CHECK(run_profile(other).ran == 1);
    }
    return LoadedScene{fake_scene(source.scene), "nowhere"};
  };
  const RunSummary summary = run_profile(options);
  CHECK(summary.ran == 1);
  CHECK(summary.reused == 1);
}

TEST_CASE("a run folder holds the files of the contract") {
  const test::TempFolder folder;
  const RunnerOptions options = fake_run(folder.path());
  run_profile(options);
  const fs::path run = folder.path() / "runs/room_1/fake/0";
  for (const char* file :
       {"config.json",
        "env.json",
        "metrics.json",
        "log.jsonl",
        "interface.ply",
        "strip.png",
        "checkpoint/progress.json",
        "renders/0002/rgb.exr",
        "renders/0002/rgb.png",
        "renders/0002/depth.exr",
        "renders/0003/strip.png",
        "renders/0003/transparency.exr",
        "renders/0003/interface.png"}) {
    INFO(file);
    CHECK(fs::exists(run / file));
  }
  CHECK(!fs::exists(run / "checkpoint/state.safetensors"));  // its last state is in its files
  // Rendered as views of the dataset, not as mere cameras.
  CHECK(read_image(run / "renders/0002/transparency.exr", 1).at(3, 3) == Approx(0.5f));
  const Json metrics = Json::parse(read_file(run / "metrics.json"));
  CHECK(metrics["views"][0]["name"] == "0002");
  CHECK(metrics["views"][0]["metrics"].contains("psnr"));
  CHECK(metrics["protocol"].contains("psnr"));
  CHECK(metrics["protocol"]["fps"]["frames"] == options.profile.timing_frames);
  CHECK(metrics["protocol"]["fps"]["warmup"] == options.profile.timing_warmup);
}

TEST_CASE("scores come from the files of the run folder") {
  const test::TempFolder folder;
  const RunnerOptions options = fake_run(folder.path());
  run_profile(options);
  const RunSpec spec = read_run_spec(folder.path() / "runs/room_1/fake/0");
  write_exr(spec.folder / "renders/0002/rgb.exr", Image(16, 12, 3, 0.6f));
  const auto means = eval_stage(spec, fake_scene("room_1"));
  CHECK(means.at("psnr") > 50);
}

TEST_CASE("a second run reuses finished cells, a changed configuration runs again") {
  const test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  run_profile(options);
  const int trainings = FakeMethod::trainings;
  CHECK(run_profile(options).reused == 4);
  CHECK(FakeMethod::trainings == trainings);
  options.assignments = {"fake/other.grey=0.25"};
  const RunSummary changed = run_profile(options);
  CHECK(changed.reused == 2);
  CHECK(changed.ran == 2);
  options.force = true;
  CHECK(run_profile(options).ran == 4);
}

TEST_CASE("a finished cell has a key for each stage, and its record the two that count") {
  OneCell cell;
  CHECK(cell.stages().done());
  for (const char* stage : {"train", "render", "mesh", "score"})
    CHECK(fs::exists(cell.run / "keys" / (std::string(stage) + ".json")));
  const auto records = read_records(cell.folder.path() / "records.jsonl");
  const CellStages stages = cell.stages();
  CHECK(records[0].train_key == stages[Stage::kTrain].key());
  CHECK(records[0].score_key == stages[Stage::kScore].key());
  CHECK(records[0].train_key.size() == 20);
  CHECK(cell.run_again(0) == "");
}

TEST_CASE("only what has changed runs again, and the plan says why") {
  OneCell cell;
  cell.options.profile.mesh_metrics["num_samples"] = 10;
  CHECK(cell.stages().why() == "score: mesh_metrics.num_samples 1000000 -> 10");
  CHECK(cell.run_again(0) == "score");
  cell.options.profile.mesh["voxel"] = 0.5;
  CHECK(
      cell.stages().why() ==
      "mesh: mesh.voxel 0.01 -> 0.5; score: mesh_metrics.cull_tolerance_m 0.02 -> 1"
  );
  CHECK(cell.run_again(0) == "mesh score");
  cell.options.profile.timing_frames = 3;
  CHECK(cell.run_again(0) == "score");
  cell.options.profile.iterations = 20;
  CHECK(
      cell.stages().why() ==
      "train: iterations 10 -> 20; render: after train; mesh: after train; score: after render, "
      "mesh"
  );
  CHECK(cell.run_again(1) == "train render mesh score");
  cell.options.identify = [](const SceneSource& source) {
    SceneIdentity identity = fake_identity(source);
    identity.document["content"] = "other";
    return identity;
  };
  CHECK(cell.stages()[Stage::kTrain].why == "other files in the data");
  CHECK(cell.run_again(1) == "train render mesh score");
}

TEST_CASE("a stage whose files are damaged or gone is not done") {
  OneCell cell;
  fs::remove(cell.run / "renders/0002/rgb.exr");
  CHECK(cell.stages()[Stage::kRender].why == "renders/0002/rgb.exr is missing");
  CHECK(cell.run_again(0) == "render score");
  write_file(cell.run / "renders/0002/rgb.exr", "half");
  CHECK_THAT(cell.stages()[Stage::kRender].why, Catch::Contains("has 4 bytes, had"));
  CHECK(cell.run_again(0) == "render score");
  fs::remove(cell.run / "metrics.json");
  CHECK(cell.run_again(0) == "score");
  fs::remove(cell.run / "interface.ply");
  CHECK(cell.run_again(1) == "train render mesh score");
}

TEST_CASE("a stage that was interrupted is not done") {
  OneCell cell;
  fs::remove(cell.run / "keys/mesh.json");
  CHECK(cell.run_again(0) == "mesh score");
  write_file(cell.run / "keys/render.json", "{\"key\": \"torn");
  CHECK(cell.run_again(0) == "render score");
}

TEST_CASE("runs and records of earlier versions are run again, with a line that says why") {
  OneCell cell;
  fs::remove_all(cell.run / "keys");
  CHECK_THAT(cell.stages().why(), Catch::Contains("trained by an earlier version, without a key"));
  fs::remove_all(cell.run);
  Record record;
  record.cell = {"room_1", "fake", 0};
  record.schema = 1;
  record.metrics = {{"psnr", 20.0}};
  append_record(cell.folder.path() / "records.jsonl", record);
  CHECK_THAT(cell.stages().why(), Catch::Contains("recorded by an earlier version"));
  CHECK(cell.run_again(1) == "train render mesh score");
}

TEST_CASE("what was scored with files that have gone since stays scored; gained ones count") {
  OneCell cell;
  const fs::path records = cell.folder.path() / "records.jsonl";
  const auto scored_with = [&](const Json& lpips) {
    Json document = read_stage(cell.run, Stage::kScore)->document;
    document["machine"]["lpips-alex"] = lpips;
    write_stage(cell.run, Stage::kScore, document, {"metrics.json"});
    Record record = read_records(records)[0];
    record.score_key = stage_key(document);
    append_record(records, record);
  };
  scored_with({{"sha256", "a"}});
  CHECK(cell.run_again(0) == "");
  CHECK(cell.stages()[Stage::kScore].key() == read_records(records)[0].score_key);
}

TEST_CASE("a trained cell without a record is scored without training again") {
  OneCell cell;
  fs::remove(cell.folder.path() / "records.jsonl");
  CHECK(cell.stages().why() == "score: not in the records");
  CHECK(cell.run_again(0) == "score");
}

TEST_CASE("data that were made again to the same bytes change nothing") {
  OneCell cell;
  bool made = false;
  cell.options.identify = [&](const SceneSource& source) {
    SceneIdentity identity = fake_identity(source);
    if (made) return identity;
    identity.document.erase("content");
    identity.why_not = "code of datasets/glassroom/room.cpp";
    return identity;
  };
  cell.options.load = [&](const SceneSource& source) {
    made = true;
    return LoadedScene{fake_scene(source.scene), "nowhere"};
  };
  CHECK_THAT(cell.stages().why(), Catch::StartsWith("data: code of datasets/glassroom/room.cpp"));
  CHECK(run_profile(cell.options).reused == 1);
  CHECK(made);
}

TEST_CASE("a method that throws becomes a failure record and the others go on") {
  const std::pair<const char*, const char*> cases[] = {
      {"initialize", "train"}, {"step", "train"}, {"render", "render"}};
  for (const auto& [place, stage] : cases) {
    const test::TempFolder folder;
    RunnerOptions options = fake_run(folder.path());
    options.assignments = {std::string("fake.fails=") + place};
    const RunSummary summary = run_profile(options);
    CHECK(summary.failed == 2);
    CHECK(summary.ran == 2);
    const auto records = read_records(folder.path() / "records.jsonl");
    const Record* record = find_record(records, {"room_1", "fake", 0});
    REQUIRE(record);
    REQUIRE_FALSE(record->ok());
    CHECK(record->failure->stage == stage);
    CHECK(record->failure->kind == "unknown");
    CHECK(record->failure->message == std::string("fake failure in ") + place);
    CHECK(record->metrics.empty());
  }
}

TEST_CASE(
    "a device that is lost ends the profile; what was finished stays, and the rest goes on later"
) {
  const test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  options.assignments = {"fake/other.fails=device"};  // the second of four
  CHECK_THROWS_AS(run_profile(options), DeviceLost);
  const auto records = read_records(folder.path() / "records.jsonl");
  REQUIRE(records.size() == 1);
  CHECK(records[0].ok());
  options.assignments.clear();
  const RunSummary summary = run_profile(options);
  CHECK(summary.reused == 1);
  CHECK(summary.ran == 3);
}

TEST_CASE("a loss that is not finite is told apart from bad input") {
  const test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  options.assignments = {"fails=loss"};
  options.filter.only = {"room_1/fake/0"};
  CHECK(run_profile(options).failed == 1);
  const auto records = read_records(folder.path() / "records.jsonl");
  REQUIRE(records.size() == 1);
  CHECK(records[0].failure->kind == "not-finite");
  CHECK_THAT(records[0].failure->message, Catch::Contains("photometric"));
}

TEST_CASE("a scene that cannot be had fails its cells and no others") {
  const test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  options.load = [](const SceneSource& source) {
    GLINT_CHECK(source.scene != "room_1", kBadReference, "images/0001.png: truncated");
    return LoadedScene{fake_scene(source.scene), "nowhere"};
  };
  const RunSummary summary = run_profile(options);
  CHECK(summary.failed == 2);
  CHECK(summary.ran == 2);
  const auto records = read_records(folder.path() / "records.jsonl");
  CHECK(records[0].failure->stage == "data");
  CHECK(records[0].failure->kind == "bad-input");
}

TEST_CASE("a failed cell runs again and its record is replaced") {
  const test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  options.assignments = {"fails=step"};
  CHECK(run_profile(options).failed == 4);
  options.assignments.clear();
  CHECK(run_profile(options).ran == 4);
  for (const Record& record : read_records(folder.path() / "records.jsonl")) CHECK(record.ok());
}

TEST_CASE("a folder that holds other people's files is not emptied") {
  const test::TempFolder folder;
  write_file(folder.path() / "runs/room_1/fake/0/thesis.txt", "years of work");
  RunnerOptions options = fake_run(folder.path());
  options.filter.only = {"room_1/fake/0"};
  CHECK(run_profile(options).failed == 1);
  CHECK(fs::exists(folder.path() / "runs/room_1/fake/0/thesis.txt"));
}

TEST_CASE("a damaged render is an error of the prediction, naming the file") {
  const test::TempFolder folder;
  run_profile(fake_run(folder.path()));
  const RunSpec spec = read_run_spec(folder.path() / "runs/room_1/fake/0");
  const auto check = [&](const char* message) {
    const std::string error =
        test::error_of(ExitCode::kBadPrediction, [&] { eval_stage(spec, fake_scene("room_1")); });
    CHECK_THAT(error, Catch::Contains(message));
  };
  const fs::path rgb = spec.folder / "renders/0002/rgb.exr";
  write_exr(rgb, Image(8, 6, 3));
  check("8x6");
  write_file(rgb, read_file(rgb).substr(0, 60));
  check("rgb.exr");
  fs::remove(rgb);
  check("glint-bench render");
}

TEST_CASE("tables of a whole run are written in four formats") {
  const test::TempFolder folder;
  run_profile(fake_run(folder.path()));
  write_tables(folder.path(), result_tables(folder.path()));
  for (const char* table :
       {"table1_photometric",
        "table2_geometry",
        "table3_ablation",
        "tableB_cost",
        "regions",
        "decomposition"})
    for (const char* extension : {".md", ".tex", ".csv", ".json"})
      CHECK(fs::exists(folder.path() / "tables" / (std::string(table) + extension)));
  CHECK_THROWS_AS(result_tables(folder.path(), {"table9"}), Error);
}

TEST_CASE("a table of what only some data has is there where it was measured, and where asked for"
) {
  const test::TempFolder folder;
  Record record;
  record.dataset = "glassroom";
  record.cell = {"room_1", "glint", 0};
  record.metrics = {{"psnr", 30}};
  append_record(folder / "records.jsonl", record);
  const auto has_layers = [&](const std::vector<std::string>& ids) {
    const auto tables = result_tables(folder.path(), ids);
    return std::ranges::any_of(tables, [](const Table& table) { return table.id == "layers"; });
  };
  CHECK_FALSE(has_layers({}));
  CHECK(has_layers({"layers"}));
  record.metrics["layer-last-absrel"] = 0.1;
  append_record(folder / "records.jsonl", record);
  CHECK(has_layers({}));
}
