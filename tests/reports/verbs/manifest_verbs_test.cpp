// SPDX-License-Identifier: MIT
// Published datasets as a user meets them, with small rooms in the official layout in their place:
// info, check, doctor, and a profile that runs what is there.
#include <catch2/catch.hpp>

#include "datasets/map_resize.h"
#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "reports/run/records/records.h"
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
  // True geometry of test view 0000, as the release has it.
  void write_truth() const {
    const fs::path truth = scene.parent_path() / "geometry_gt/scene_2";
    const View view = box_room_views(1, {64, 48})[0];
    write_npy(truth / "depths_gt/val_depthZ_0000.npy", view.truth["depth"]);
    write_npy(truth / "normals_gt/val_normalCam_0000.npy", view.truth["normal"]);
  }
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
  CHECK(scene["test_views_with_true_depth"] == 0);
  CHECK(scene["stored_size"] == "64x48");
  CHECK(scene["used_size"] == "32x24");
  CHECK(scene["first_hash"] == "");
  const std::string hash = scene["hash"];
  // Counts fit; a room is not the scene, so extent and bounds do not.
  std::string findings = json["findings"].dump();
  CHECK_THAT(findings, !Contains("manifest-views") && Contains("manifest-extent"));
  CHECK_THAT(findings, Contains("manifest-bounds") && Contains("4 of 5 scenes are missing"));

  write_file(official.scene / "diffrens/basecolor/later.txt", "priors are no part of it");
  official.write_truth();
  json = official.info();
  CHECK(json["scenes"][1]["test_views_with_true_depth"] == 1);
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

// A profile of one method of three steps, on what there is of 3D-FRONT-T.
struct ShortProfile {
  const OfficialData& official;
  std::string file = official.path() / "mine.toml", out = official.path() / "out";
  explicit ShortProfile(const OfficialData& data) : official(data) {
    write_file(
        file,
        "iterations = 3\nmethods = [\"2dgs\"]\nmanifests = [\"3d-front-t\"]\ntiming_frames = 1\n"
        "timing_warmup = 0\n"
    );
  }
  Json run_cells(const std::string& only, int code) const {
    const std::string summary = captured(1, [&] {
      CHECK(
          run(with_common({"all", "--no-tables", "--executor", "inline", "--only", only, "--json"})
          ) == code
      );
    });
    return summary.empty() ? Json() : Json::parse(summary);
  }
  std::vector<std::string> with_common(std::vector<std::string> words) const {
    words.insert(
        words.end(), {"--profile", file, "--data", official.data(), "--out", out, "--quiet"}
    );
    return words;
  }
  std::vector<Record> records() const { return read_records(fs::path(out) / "mine/records.jsonl"); }
};

TEST_CASE("a profile runs the scenes of a published dataset that are there, and exits with 5") {
  const OfficialData official(12);
  const ShortProfile profile(official);
  const Json summary = profile.run_cells("*", 5);
  CHECK(summary["ran"] == 1);
  CHECK(summary["failed"] == 0);
  CHECK(summary["without_data"] == 4);
  const auto records = profile.records();
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
  CHECK(profile.run_cells("scene_2/*", 0)["reused"] == 1);
  CHECK(profile.run_cells("scene_3/*", 3).is_null());
}

TEST_CASE("true geometry that comes later is scored, without training again") {
  const OfficialData official(12);
  const ShortProfile profile(official);
  profile.run_cells("scene_2/*", 0);
  CHECK_FALSE(profile.records().back().metrics.contains("normal-mae"));
  const std::string model = profile.out + "/mine/runs/scene_2/2dgs/0/keys/train.json";
  const auto trained = fs::last_write_time(model);
  official.write_truth();
  CHECK(profile.run_cells("scene_2/*", 0)["ran"] == 1);
  CHECK(fs::last_write_time(model) == trained);
  CHECK(profile.records().back().metrics.at("normal-mae") > 0);
  CHECK(run(profile.with_common({"verify"})) == 0);
  CHECK(profile.run_cells("scene_2/*", 0)["reused"] == 1);
}

// What the release's evaluate_dataset leaves: half-size pictures, depth and normals of test views.
TEST_CASE("what the official code rendered is scored as the profile's scene, at its size") {
  const OfficialData official(12);
  const ShortProfile profile(official);
  official.write_truth();
  const fs::path theirs = official.path() / "eval";
  const auto views = box_room_views(12, {64, 48}, 6.28 / 12);
  const ImageSize half{32, 24};
  for (const std::size_t view : {0u, 8u}) {
    const std::string name = fmt::format("{:04}", view);
    write_png(
        theirs / fmt::format("pred/{0}_{0}_000000.png", name), resize_image(views[view].rgb, half)
    );
    write_npy(
        theirs / "geometry/depths_pred" / (name + ".npy"),
        resize_depth(views[view].truth["depth"], half)
    );
    write_npy(
        theirs / "geometry/normals_pred" / (name + ".npy"),
        resize_normal(views[view].truth["normal"], half)
    );
  }
  CHECK(
      run(profile.with_common(
          {"eval",
           "--predictions",
           theirs.string(),
           "--dataset",
           official.scene.string(),
           "--method",
           "official"}
      )) == 0
  );
  const auto records = profile.records();
  REQUIRE(records.size() == 1);
  CHECK(records[0].dataset == "3d-front-t");
  CHECK(records[0].cell.scene == "scene_2");
  CHECK(records[0].resolution == "32x24");
  CHECK(records[0].metrics.at("depth-absrel") < 1e-6);
  CHECK(records[0].metrics.at("normal-mae") < 0.1);  // of float32 cosines near 1
  CHECK(records[0].metrics.at("psnr-8bit") > 48.1);  // rounded before and after: 1 / 255 at most
}
