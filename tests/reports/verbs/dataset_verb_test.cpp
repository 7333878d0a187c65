// SPDX-License-Identifier: MIT
// `dataset export` and `dataset info` as a user sees them.
#include <catch2/catch.hpp>

#include "glint/core/config.h"
#include "reports/verbs/print_findings.h"
#include "tests/reports/run_words.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

// What a command that succeeds prints on standard output.
std::string output_of(const std::vector<std::string>& words) {
  return captured(1, [&] { CHECK(run(words) == 0); });
}

}  // namespace

TEST_CASE("a scene and its packed file are exported to every format and checked there") {
  const TempFolder folder;
  const std::string room = small_room_folder().string(), packed = folder / "room.safetensors";
  REQUIRE(run({"dataset", "pack", room, packed, "--quiet"}) == 0);
  for (const std::string format : {"blender", "colmap", "easyvolcap", "nerfstudio"}) {
    INFO(format);
    const std::string out = folder / format;
    CHECK_THAT(
        output_of({"dataset", "export", room, "--format", format, "--out", out, "--quiet"}),
        Contains(out + ": " + format) && Contains("16 views (14 train, 2 test)") &&
            Contains("priors are simulated")
    );
    CHECK(run({"dataset", "check", out, "--quiet"}) == 0);
    // Earlier exports need --force.
    const std::vector<std::string> again = {
        "dataset", "export", packed, "--format", format, "--out", out, "--quiet", "--json"};
    CHECK(run(again) == 1);
    std::vector<std::string> forced = again;
    forced.push_back("--force");
    const Json json = Json::parse(output_of(forced));
    CHECK(json["format"] == format);
    CHECK(json["parts"][0]["what"].is_string());
    CHECK(json["notes"].size() > 1);
  }
}

TEST_CASE("dataset pack replaces a packed scene, and no other file or folder") {
  const TempFolder folder;
  const std::string room = small_room_folder().string(), picture = folder / "picture.png";
  const auto refusal = [&](const std::string& target) {
    return captured(2, [&] { CHECK(run({"dataset", "pack", room, target, "--quiet"}) == 1); });
  };
  write_file(picture, "a picture");
  CHECK_THAT(refusal(picture), Contains("picture.png: is there and is no packed scene"));
  CHECK(read_file(picture) == "a picture");
  CHECK_THAT(refusal(folder.path()), Contains(": is a folder; give the name of a file"));
  CHECK_THAT(refusal(folder / "new/"), Contains("new/scene.safetensors"));
  const std::string packed = folder / "room.safetensors";
  for (int i = 0; i < 2; ++i) CHECK(run({"dataset", "pack", room, packed, "--quiet"}) == 0);
}

TEST_CASE("an export needs a folder, a format and a scene") {
  const TempFolder folder;
  const std::string out = folder / "out", room = small_room_folder().string();
  CHECK(run({"dataset", "export", room, "--format", "colmap"}) == 1);
  CHECK(run({"dataset", "export", room, "--out", out}) == 1);
  CHECK(run({"dataset", "export", room, "--format", "usd", "--out", out}) == 1);
  CHECK(
      run({"dataset", "export", room, "--format", "colmap", "--split", "val", "--out", out}) == 1
  );
  CHECK(run({"dataset", "export", "nowhere", "--format", "colmap", "--out", out}) == 3);
  CHECK_FALSE(fs::exists(out));
}

namespace {

std::vector<std::string> make_tiny(const std::string& out, const std::string& priors) {
  std::vector<std::string> words{"dataset", "make", "glassroom", "--out", out, "--priors", priors};
  for (const char* word : {"--width", "32", "--height", "18", "--views", "8", "--spp", "1"})
    words.emplace_back(word);
  words.emplace_back("--quiet");
  return words;
}

}  // namespace

TEST_CASE("dataset make takes a level of priors, and no other word") {
  const TempFolder folder;
  CHECK(run(make_tiny(folder / "awful", "awful")) == 1);
  CHECK_FALSE(fs::exists(folder / "awful"));
  REQUIRE(run(make_tiny(folder / "poor", "poor")) == 0);
  CHECK(Json::parse(read_file(folder / "poor/scene.json"))["prior_level"] == "poor");
}

TEST_CASE("dataset make glassroom refuses what only 3D-FRONT looks at") {
  const TempFolder folder;
  const std::string text = captured(2, [&] {
    CHECK(
        run({"dataset", "make", "glassroom", "--out", folder / "room", "--house", "a.json"}) == 1
    );
  });
  CHECK_THAT(text, Contains("--house a.json is of front3d alone"));
  CHECK_FALSE(fs::exists(folder / "room"));
}

TEST_CASE("of what is found in each frame the first three are told, and how many more") {
  std::vector<Finding> findings = {{"pose", "frame x", "far"}};
  for (const char* frame : {"frame 0", "frame 1", "frame 2"})
    findings.push_back({"pose", frame, "damaged"});
  const std::string few = findings_text(findings);
  CHECK(std::count(few.begin(), few.end(), '\n') == 4);
  CHECK_THAT(few, !Contains("more"));
  for (const char* frame : {"frame 3", "frame 4"}) findings.push_back({"pose", frame, "damaged"});
  const std::string many = findings_text(findings);
  CHECK(std::count(many.begin(), many.end(), '\n') == 4);
  CHECK_THAT(many, Contains("pose: frame 2: damaged (and 2 more; --json names all)\n"));
}

TEST_CASE("a scene of other options is replaced, and what they were is said") {
  const TempFolder folder;
  const std::string out = folder / "room";
  const auto said_of = [&](const std::string& priors) {
    return captured(2, [&] { CHECK(run(make_tiny(out, priors)) == 0); });
  };
  CHECK(said_of("poor").empty());
  CHECK(said_of("poor").empty());  // was there already
  CHECK_THAT(
      said_of("good"), Contains("room: the scene there is replaced (priors \"poor\", now \"good\")")
  );
}

TEST_CASE("files of a made scene that are gone or changed are found") {
  const TempFolder folder;
  const std::string room = folder / "room";
  fs::copy(small_room_folder(), room, fs::copy_options::recursive);
  const auto found = [&] {
    return captured(1, [&] { run({"dataset", "check", room, "--quiet"}); });
  };
  CHECK_THAT(found(), Contains("nothing wrong"));
  fs::remove_all(fs::path(room) / "diffrens");
  CHECK_THAT(found(), Contains("recorded-files") && Contains("diffrens") && Contains("is missing"));
  write_file(fs::path(room) / "sparse/0/points3D.ply", read_file(fs::path(room) / "gt/mesh.ply"));
  CHECK_THAT(found(), Contains("points3D.ply: has other bytes than it was written with"));
}

TEST_CASE("dataset make front3d takes a house, and says what is wrong with one") {
  const TempFolder folder;
  const std::string out = folder / "room";
  const auto make = [&](std::vector<std::string> more) {
    std::vector<std::string> words{
        "dataset",
        "make",
        "front3d",
        "--width",
        "32",
        "--height",
        "18",
        "--spp",
        "1",
        "--views",
        "8",
        "--quiet",
        "--json",
        "--out",
        out};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const std::string house = "tests/datasets/front3d/house_rows.json", bad = folder / "bad.json";
  write_file(bad, "{}");
  CHECK(run(make({})) == 1);
  CHECK(run(make({"--house", "nowhere.json"})) == 3);
  CHECK(run(make({"--house", bad})) == 3);
  CHECK(run(make({"--house", house, "--room", "Attic"})) == 1);
  CHECK(run(make({"--house", house, "--models", folder / "nowhere"})) == 3);
  CHECK(run(make({"--house", house, "--textures", folder / "nowhere"})) == 3);
  CHECK(run(make({"--house", house, "--priors", "awful"})) == 1);
  CHECK_FALSE(fs::exists(out));
  const Json json = Json::parse(output_of(make({"--house", house})));
  CHECK(json["scenes"][0]["scene"] == "house_rows-LivingDiningRoom-2");
  CHECK(json["scenes"][0]["folder"] == out);
  CHECK(json["scenes"][0]["made"] == true);
  CHECK(run({"dataset", "check", out, "--quiet"}) == 0);
  CHECK(run({"dataset", "make", "ikea", "--out", out}) == 1);
}

TEST_CASE("dataset info says the format, the split's rule and the test views") {
  const std::string room = small_room_folder().string();
  CHECK_THAT(
      output_of({"dataset", "info", room, "--quiet"}),
      Contains("format         easyvolcap\n") &&
          Contains("split          view 0, 8, 16, ... in the order of names\n") &&
          Contains("test views     0000, 0008\n")
  );
  const Json json = Json::parse(output_of({"dataset", "info", room, "--quiet", "--json"}));
  CHECK(json["loader"] == "easyvolcap");
  CHECK(json["test_view_names"] == Json({"0000", "0008"}));
  CHECK(json["test_views"] == 2);
  CHECK(json["split_rule"] == "view 0, 8, 16, ... in the order of names");
}
