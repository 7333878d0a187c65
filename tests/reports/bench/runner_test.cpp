// SPDX-License-Identifier: MIT
#include "reports/bench/runner.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "reports/verbs/result_tables.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

// A profile of folder scenes, so that nothing has to be rendered.
RunnerOptions fake_run(const fs::path& out) {
  static const bool registered = (register_fake_methods(), set_quiet(true), true);
  REQUIRE(registered);
  RunnerOptions options;
  options.profile.name = "fake";
  options.profile.iterations = 10;
  options.profile.methods = {"fake", "fake/other"};
  options.profile.timing_frames = 2;
  for (const char* scene : {"room_1", "room_2"})
    options.profile.scenes.push_back({{"scene", scene}, {"folder", "nowhere"}});
  options.out = out;
  options.load = [](const SceneSource& source) {
    return LoadedScene{fake_scene(source.scene), "nowhere"};
  };
  return options;
}

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
  const auto& absent = records[0].not_applicable;
  CHECK(std::count(absent.begin(), absent.end(), "transparency-iou") == 1);
  CHECK(std::count(absent.begin(), absent.end(), "psnr") == 0);
  CHECK(records[0].environment.at("device") == "cpu");
}

TEST_CASE("a run folder holds the files of the contract") {
  const test::TempFolder folder;
  run_profile(fake_run(folder.path()));
  const fs::path run = folder.path() / "runs/room_1/fake/0";
  for (const char* file :
       {"config.json",
        "env.json",
        "metrics.json",
        "log.jsonl",
        "interface.ply",
        "strip.png",
        "checkpoint",
        "renders/0002/rgb.exr",
        "renders/0002/rgb.png",
        "renders/0002/depth.exr",
        "renders/0003/strip.png",
        "renders/0003/transparency.exr",
        "renders/0003/interface.png"}) {
    INFO(file);
    CHECK(fs::exists(run / file));
  }
  const Json metrics = Json::parse(read_file(run / "metrics.json"));
  CHECK(metrics["views"][0]["name"] == "0002");
  CHECK(metrics["views"][0]["metrics"].contains("psnr"));
  CHECK(metrics["protocol"].contains("psnr"));
}

TEST_CASE("scores come from the files of the run folder") {
  const test::TempFolder folder;
  const RunnerOptions options = fake_run(folder.path());
  run_profile(options);
  const RunSpec spec = read_run_spec(folder.path() / "runs/room_1/fake/0");
  write_exr(spec.folder / "renders/0002/rgb.exr", Image(16, 12, 3, 0.6f));
  const auto means = eval_stage(spec, fake_scene("room_1"), {});
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

TEST_CASE("a run that other code trained is scored again on request, and the record says so") {
  const test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  run_profile(options);
  const int trainings = FakeMethod::trainings;
  const fs::path run = folder.path() / "runs/room_1/fake/0";
  for (const char* file : {"config.json", "env.json"}) {
    Json json = Json::parse(read_file(run / file));
    json["config_hash"] = "0123456789abcdef";
    json["git_revision"] = "abc1234";
    write_file(run / file, json.dump());
  }
  fs::remove(folder.path() / "records.jsonl");
  options.rescore = true;
  CHECK(run_profile(options).ran == 4);
  CHECK(FakeMethod::trainings == trainings);
  const auto records = read_records(folder.path() / "records.jsonl");
  CHECK(records[0].config_hash == "0123456789abcdef");
  CHECK(records[0].warnings.at(0) == "trained by revision abc1234");
  options.profile.iterations = 20;  // that is no such run
  run_profile(options);
  CHECK(FakeMethod::trainings == trainings + 4);
}

TEST_CASE("a trained cell without a record is scored without training again") {
  const test::TempFolder folder;
  const RunnerOptions options = fake_run(folder.path());
  run_profile(options);
  const int trainings = FakeMethod::trainings;
  fs::remove(folder.path() / "records.jsonl");
  CHECK(run_profile(options).ran == 4);
  CHECK(FakeMethod::trainings == trainings);
}

TEST_CASE("a method that throws becomes a failure record and the others go on") {
  const std::pair<const char*, const char*> cases[] = {
      {"initialize", "train"}, {"step", "train"}, {"render", "eval"}};
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
  CHECK(records[0].failure->stage == "dataset");
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
    const std::string error = test::error_of(ExitCode::kBadPrediction, [&] {
      eval_stage(spec, fake_scene("room_1"), {});
    });
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
