// SPDX-License-Identifier: MIT
// Published datasets as a user meets them, with small rooms in the official layout in their place:
// info, check, doctor, and a profile that runs what is there.
#include <catch2/catch.hpp>

#include "glint/core/config.h"
#include "reports/records/records.h"
#include "tests/reports/run_words.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

// DATA with scene_2 of 3D-FRONT-T: `views` of them, of 64 x 48 pixels, without ground truth.
struct OfficialData : TempFolder {
  fs::path scene = path() / "data/3d-front-t/scene_2";
  explicit OfficialData(int views) {
    write_easyvolcap(scene, box_room_views(views, {64, 48}, 6.28 / views));
    fs::remove_all(scene / "gt");
  }
  std::string data() const { return (path() / "data").string(); }
  Json info() const {
    return Json::parse(captured(1, [&] {
      CHECK(run({"dataset", "info", "3d-front-t", "--data", data(), "--json", "--quiet"}) == 0);
    }));
  }
};

}  // namespace

TEST_CASE("info of a published dataset says what is there, its counts, sizes and hashes") {
  const OfficialData official(181);
  Json json = official.info();
  CHECK(json["scenes"].size() == 5);
  const Json& scene = json["scenes"][1];
  CHECK(scene["there"] == true);
  CHECK(json["scenes"][0]["there"] == false);
  CHECK(scene["train_views"] == 158);
  CHECK(scene["test_views"] == 23);
  CHECK(scene["stored_size"] == "64x48");
  CHECK(scene["used_size"] == "32x24");
  CHECK(scene["first_hash"] == "");
  const std::string hash = scene["hash"];
  // Counts fit; a room is not the scene, so extent and bounds do not.
  std::string findings = json["findings"].dump();
  CHECK_THAT(findings, !Contains("manifest-views") && Contains("manifest-extent"));
  CHECK_THAT(findings, Contains("manifest-bounds") && Contains("4 of 5 scenes are missing"));

  write_file(official.scene / "diffrens/basecolor/later.txt", "priors are no part of it");
  json = official.info();
  CHECK(json["scenes"][1]["first_hash"] == hash);
  CHECK(json["scenes"][1]["hash"] == hash);
  write_file(
      official.scene / "images/0003/000000.png",
      read_file(official.scene / "images/0004/000000.png")
  );
  json = official.info();
  CHECK(json["scenes"][1]["hash"] != hash);
  CHECK_THAT(json["findings"].dump(), Contains("manifest-hash"));
}

TEST_CASE("check of a published dataset compares counts, by name and by folder") {
  const OfficialData official(20);
  const auto check = [&](const std::string& name) {
    return captured(1, [&] {
      CHECK(run({"dataset", "check", name, "--data", official.data(), "--quiet"}) == 4);
    });
  };
  CHECK_THAT(
      check("3d-front-t"), Contains("17 training and 3 test views; the release has 158 and 23")
  );
  CHECK_THAT(check(official.scene.parent_path().string()), Contains("manifest-views"));
  CHECK_THAT(check("ref-dl3dv"), Contains("missing-scene") && Contains("8 of 8"));
}

TEST_CASE("a profile runs the scenes of a published dataset that are there, and exits with 5") {
  const OfficialData official(12);
  const std::string profile = official.path() / "mine.toml", out = official.path() / "out";
  write_file(
      profile,
      "iterations = 3\nmethods = [\"2dgs\"]\nmanifests = [\"3d-front-t\"]\ntiming_frames = 1\n"
      "timing_warmup = 0\n"
  );
  const auto run_profile = [&](const std::string& only, int code) {
    const std::string summary = captured(1, [&] {
      CHECK(
          run(
              {"run",
               "--profile",
               profile,
               "--data",
               official.data(),
               "--out",
               out,
               "--executor",
               "inline",
               "--only",
               only,
               "--json"}
          ) == code
      );
    });
    return summary.empty() ? Json() : Json::parse(summary);
  };
  const Json summary = run_profile("*", 5);
  CHECK(summary["ran"] == 1);
  CHECK(summary["failed"] == 0);
  CHECK(summary["without_data"] == 4);
  const auto records = read_records(fs::path(out) / "mine/records.jsonl");
  REQUIRE(records.size() == 1);
  CHECK(records[0].ok());
  CHECK(records[0].dataset == "3d-front-t");
  CHECK(records[0].cell.scene == "scene_2");
  CHECK(records[0].resolution == "32x24");
  REQUIRE(records[0].data_notes.size() > 3);
  CHECK_THAT(
      records[0].data_notes[0], Contains("normal priors: opencv axes, detected, as documented")
  );
  CHECK_THAT(records[0].data_notes.back(), Contains("0.5 of the stored sides"));
  // The scene alone is whole, others alone are an error.
  CHECK(run_profile("scene_2/*", 0)["reused"] == 1);
  CHECK(run_profile("scene_3/*", 3).is_null());
}
