// SPDX-License-Identifier: MIT
// Runs and imports apart from `all`: where their numbers land, and what is not overwritten.
#include <catch2/catch.hpp>

#include <vector>

#include "glint/scene/image_files.h"
#include "reports/run/records/records.h"
#include "reports/run/records/run_folder.h"
#include "reports/run/records/stage_files.h"
#include "reports/verbs/command_line.h"
#include "reports/verbs/headline_scores.h"
#include "tests/support/small_room.h"

using namespace glint;

namespace {

int run(const std::vector<std::string>& words) {
  std::vector<const char*> arguments{"glint-bench"};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  arguments.push_back("--quiet");
  return run_command_line(static_cast<int>(arguments.size()), arguments.data());
}

std::string room() { return test::small_room_folder().string(); }

}  // namespace

TEST_CASE("a single run lands in the records of OUT/single when it is scored") {
  const test::TempFolder folder;
  const std::string out = folder / "out", data = folder / "data", mine = folder / "mine";
  const std::vector<std::string> train = {
      "train",
      "--dataset",
      room(),
      "--run",
      mine,
      "--iterations",
      "3",
      "--out",
      out,
      "--data",
      data};
  REQUIRE(run(train) == 0);
  CHECK(run(train) == 1);  // it would be overwritten
  auto again = train;
  again.emplace_back("--force");
  CHECK(run(again) == 0);
  REQUIRE(run({"render", "--run", mine}) == 0);
  REQUIRE(run({"eval", "--run", mine, "--out", out}) == 0);
  const auto records = read_records(folder / "out/single/records.jsonl");
  REQUIRE(records.size() == 1);
  CHECK(records[0].cell == CellKey{"room_1", "2dgs", 0});
  CHECK(records[0].metrics.contains("psnr"));
  CHECK(records[0].resolution == "64x36");
  CHECK(records[0].training_views == static_cast<int>(test::small_room().train.size()));
  CHECK(records[0].num_surfels > 0);
  CHECK(records[0].metrics.at("num-surfels") == static_cast<double>(records[0].num_surfels));
  CHECK(records[0].metrics.at("train-minutes") > 0);
  CHECK_FALSE(records[0].train_key.empty());
  CHECK(run({"table", "--out", (folder / "out/single").string()}) == 0);
  CHECK(fs::exists(folder / "out/single/tables/summary.md"));
}

TEST_CASE("the record of a single run says why it has no mesh, and goes without a lost model") {
  const test::TempFolder folder;
  const std::string out = folder / "out", data = folder / "data", mine = folder / "mine";
  REQUIRE(
      run({"train", "--dataset", room(), "--run", mine, "--iterations", "3", "--data", data}) == 0
  );
  REQUIRE(run({"render", "--run", mine}) == 0);
  write_stage(mine, Stage::kMesh, {{"mesh", Json::object()}}, {}, "no mesh: no depth to fuse");
  const auto record = [&] {
    REQUIRE(run({"eval", "--run", mine, "--out", out}) == 0);
    return read_records(folder / "out/single/records.jsonl").at(0);
  };
  const Record first = record();
  for (const char* id : {"mesh-cd", "behind-mesh-cd"})
    CHECK(first.not_measured.at(id) == "no mesh: no depth to fuse");
  fs::remove(folder / "mine/interface.ply");
  CHECK(record().num_surfels == first.num_surfels);  // as it was scored before
}

TEST_CASE("a run that is scored on other data says so in its record; without test views it is not"
) {
  const test::TempFolder folder;
  const fs::path copy = folder.path() / "room";
  fs::copy(room(), copy, fs::copy_options::recursive);
  const std::string out = folder / "out", mine = folder / "mine";
  const std::vector<std::string> train = {
      "train", "--dataset", copy.string(), "--run", mine, "--iterations", "3", "--data", out};
  REQUIRE(run(train) == 0);
  const auto change = [&](const char* field, const Json& value) {
    Json scene = read_json_object(copy / "scene.json");
    scene[field] = value;
    write_file(copy / "scene.json", scene.dump());
  };
  change("hash", "of other data");
  REQUIRE(run({"render", "--run", mine}) == 0);
  REQUIRE(run({"eval", "--run", mine, "--out", out}) == 0);
  const Record record = read_records(fs::path(out) / "single/records.jsonl").at(0);
  REQUIRE_FALSE(record.warnings.empty());
  CHECK_THAT(record.warnings.back(), Catch::Contains("is not what"));
  CHECK(record.dataset_hash != read_run_spec(mine).dataset_hash);
  change("test_views", Json::array());
  CHECK(run({"eval", "--run", mine, "--out", out}) == 3);
}

TEST_CASE("a training that was cut off before its first checkpoint needs no --force") {
  const test::TempFolder folder;
  const std::string mine = folder / "mine";
  const std::vector<std::string> train = {
      "train", "--dataset", room(), "--run", mine, "--iterations", "3", "--data", folder / "data"};
  REQUIRE(run(train) == 0);
  for (const char* ends : {"env.json", "interface.ply"}) fs::remove(fs::path(mine) / ends);
  fs::remove_all(fs::path(mine) / "keys");
  CHECK(run(train) == 0);
  CHECK(fs::exists(fs::path(mine) / "env.json"));
}

TEST_CASE("an import that fails leaves no empty folders") {
  const test::TempFolder folder;
  fs::create_directories(folder / "theirs");
  const std::string out = folder / "out";
  CHECK(
      run(
          {"eval",
           "--predictions",
           folder / "theirs",
           "--dataset",
           room(),
           "--method",
           "theirs",
           "--out",
           out,
           "--data",
           folder / "data"}
      ) == 2
  );
  CHECK_FALSE(fs::exists(out));
}

TEST_CASE("a run of a profile is scored without touching the profile's records") {
  const test::TempFolder folder;
  const fs::path profile = folder / "out/ci";
  const std::string cell = profile / "runs/room_1/2dgs/0";
  REQUIRE(
      run(
          {"train",
           "--dataset",
           room(),
           "--run",
           cell,
           "--iterations",
           "3",
           "--data",
           folder / "data"}
      ) == 0
  );
  REQUIRE(run({"render", "--run", cell}) == 0);
  const std::string record =
      R"({"scene": "room_1", "method": "2dgs", "profile": "ci", "metrics": {"psnr": 1}})"
      "\n";
  write_file(profile / "records.jsonl", record);
  REQUIRE(run({"eval", "--run", cell, "--out", folder / "out"}) == 0);
  CHECK(read_file(profile / "records.jsonl") == record);
  CHECK_FALSE(fs::exists(folder / "out/single"));
}

TEST_CASE("an import stands beside single runs where --out is their folder") {
  const test::TempFolder folder;
  for (const View& view : test::small_room().test)
    write_png(folder / "theirs/rgb" / (view.name + ".png"), view.rgb);
  write_file(
      folder / "single/records.jsonl",
      R"({"scene": "room_1", "method": "2dgs", "profile": "single", "metrics": {"psnr": 20}})"
      "\n"
  );
  const std::string theirs = folder / "theirs", single = folder / "single", data = folder / "data";
  REQUIRE(
      run(
          {"eval",
           "--predictions",
           theirs,
           "--dataset",
           room(),
           "--method",
           "theirs",
           "--out",
           single,
           "--data",
           data}
      ) == 0
  );
  const auto records = read_records(folder / "single/records.jsonl");
  REQUIRE(records.size() == 2);
  CHECK(records[1].profile == "single");
}

TEST_CASE("headlines show the PSNR of 8-bit images under its name") {
  CHECK(headline_scores({{"psnr-8bit", 21}}).find("PSNR of 8-bit images") != std::string::npos);
  CHECK(headline_scores({{"psnr", 21}, {"psnr-8bit", 21}}).find("8-bit") == std::string::npos);
}

TEST_CASE("a second import under one name asks for --force; PNGs have psnr-8bit") {
  const test::TempFolder folder;
  for (const View& view : test::small_room().test)
    write_png(folder / "theirs/rgb" / (view.name + ".png"), view.rgb);
  const std::vector<std::string> import = {
      "eval",
      "--predictions",
      folder / "theirs",
      "--dataset",
      room(),
      "--method",
      "theirs",
      "--profile",
      "smoke",
      "--out",
      folder / "out",
      "--data",
      folder / "data"};
  REQUIRE(run(import) == 0);
  CHECK(run(import) == 1);
  auto forced = import;
  forced.emplace_back("--force");
  CHECK(run(forced) == 0);
  const auto records = read_records(folder / "out/smoke/records.jsonl");
  REQUIRE(records.size() == 1);
  CHECK_FALSE(records[0].metrics.contains("psnr"));
  CHECK(records[0].metrics.contains("psnr-8bit"));
  CHECK(records[0].not_measured.at("psnr") == "8-bit images");
}
