// SPDX-License-Identifier: MIT
// What `doctor` finds before a long run: folders, clock, data, disk and memory of a profile.
#include <catch2/catch.hpp>

#include "reports/run/bench/cell_needs.h"
#include "reports/run/provenance/examine_machine.h"
#include "reports/run/records/run_folder.h"
#include "reports/run/records/stage_files.h"
#include "tests/reports/run_words.h"
#include "tests/support/small_room.h"

using namespace glint;
using test::run;

namespace {

Profile tiny_profile(int width) {
  Profile profile;
  profile.name = "tiny";
  profile.methods = {"2dgs"};
  profile.scenes = {"room_1"};
  profile.defaults = {{"width", width}, {"height", width / 2}};
  return profile;
}

// A folder with a profile of its own, and what doctor says of it.
struct Place : test::TempFolder {
  void write_profile(const std::string& scenes) const {
    write_file(
        path() / "mine.toml",
        "iterations = 3\nmethods = [\"2dgs\"]\nscenes = [" + scenes +
            "]\n[defaults]\nwidth = 32\nheight = 18\nviews = 8\nspp = 1\n"
    );
  }
  Json doctor(int expected) const {
    const std::string text = test::captured(1, [&] {
      CHECK(
          run(
              {"doctor",
               "--profile",
               path() / "mine.toml",
               "--out",
               path() / "out",
               "--data",
               path() / "data",
               "--json",
               "--quiet"}
          ) == expected
      );
    });
    return parse_json(text);
  }
};

}  // namespace

TEST_CASE("a folder that can be written to is left as it was") {
  const test::TempFolder folder;
  const Checked found = examine_folder("out", folder / "not/there/yet", "--out");
  CHECK(found.state == CheckState::kOk);
  CHECK(fs::is_empty(folder.path()));
}

TEST_CASE("a folder that cannot be written to is found") {
  const test::TempFolder folder;
  write_file(folder / "file", "");
  const Checked found = examine_folder("out", folder / "file/out", "--out");
  CHECK(found.state == CheckState::kBad);
  CHECK(found.advice.find("--out") != std::string::npos);
  CHECK(examine_folder("out", "/proc/out", "--out").state == CheckState::kBad);
}

TEST_CASE("a clock that is before the program is wrong") {
  const std::time_t built = 1'700'000'000;
  CHECK(examine_clock(built + 1, built).state == CheckState::kOk);
  CHECK(examine_clock(built - 1, built).state == CheckState::kBad);
  CHECK(examine_clock(built, 0).state == CheckState::kOk);  // not known
}

TEST_CASE("doctor without a profile looks at the machine alone") {
  const test::TempFolder folder;
  const Json json = parse_json(test::captured(1, [&] {
    CHECK(run({"doctor", "--json", "--out", folder / "out"}) == 0);
  }));
  CHECK(json["out"]["state"] == "ok");
  CHECK(json.contains("clock"));
  CHECK(json.contains("files"));
  CHECK_FALSE(json.contains("data"));
  CHECK_FALSE(json.contains("disk of runs"));
}

TEST_CASE("doctor tells which scenes are there, will be made, are missing") {
  const Place place;
  const std::string there = "{scene = \"there\", dataset = \"mine\", folder = \"" +
                            test::small_room_folder().string() + "\"}";
  place.write_profile("\"room_1\", " + there);
  const Json fit = place.doctor(0);
  CHECK(fit["scene room_1"]["state"] == "note");
  CHECK(fit["scene there"]["state"] == "ok");
  CHECK(fit["disk of runs"]["state"] == "note");  // of a folder's data nothing is known
  place.write_profile("\"room_1\", {scene = \"gone\", dataset = \"mine\", folder = \"gone\"}");
  const Json unfit = place.doctor(6);
  CHECK(unfit["scene gone"]["state"] == "BAD");
  CHECK(unfit["scene gone"]["ok"] == false);
}

TEST_CASE("disk is estimated from pictures, and from finished runs where there are some") {
  const test::TempFolder folder;
  const auto estimate = [&](const Profile& profile) {
    return *disk_of_runs(make_plan(profile, {}, {}), profile, folder.path());
  };
  const Profile small = tiny_profile(64), large = tiny_profile(640);
  CHECK(estimate(small).from == "sizes of pictures");
  CHECK(estimate(large).bytes > estimate(small).bytes);
  Profile two = small;
  two.seeds = {0, 1};
  const fs::path finished = run_folder(folder.path(), {"room_1", "2dgs", 0});
  write_file(finished / "config.json", R"({"written_by": "glint-bench"})");
  write_file(finished / "mesh.ply", std::string(500'000'000 / 1000, 'x'));
  write_stage(finished, Stage::kScore, Json::object(), {"metrics.json"});
  CHECK(estimate(small).bytes == 0);  // nothing is left to run
  CHECK(estimate(two).from == "1 finished run");
  CHECK(estimate(two).bytes > 500'000);
}

TEST_CASE("a cell that took more memory than there is, is found") {
  const Place place;
  place.write_profile("\"room_1\"");
  const Json before = place.doctor(0)["memory of cells"];
  CHECK(before["state"] == "ok");
  CHECK_THAT(before["value"].get<std::string>(), Catch::Contains("2dgs of room_1: its images"));
  Record record;
  record.profile = "mine";
  record.cell = {"room_1", "2dgs", 0};
  record.metrics["peak-memory"] = 1e9;  // MB
  append_record(place / "out/mine/records.jsonl", record);
  CHECK(place.doctor(6)["memory of cells"]["state"] == "BAD");
}

TEST_CASE("a published dataset is one row: missing scenes are a note, other data are bad") {
  const Place place;
  place.write_profile("\"room_1\"");
  const fs::path profile = place.path() / "mine.toml";
  write_file(profile, "manifests = [\"3d-front-t\"]\n" + read_file(profile));
  Json json = place.doctor(0);
  CHECK(json["dataset 3d-front-t"]["state"] == "note");
  const std::string missing = json["dataset 3d-front-t"]["value"];
  CHECK(missing.find("5 of 5 scenes are missing") != std::string::npos);
  CHECK_FALSE(json.contains("scene scene_1"));
  fs::create_directories(place.path() / "data/3d-front-t");
  fs::copy(
      test::small_room_folder(),
      place.path() / "data/3d-front-t/scene_1",
      fs::copy_options::recursive
  );
  json = place.doctor(6);
  CHECK(json["dataset 3d-front-t"]["ok"] == false);
  const std::string wrong = json["dataset 3d-front-t"]["value"];
  CHECK(wrong.find("scene_1: 14 training and 2 test views; the release has 149") == 0);
}
