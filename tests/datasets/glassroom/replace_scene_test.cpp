// SPDX-License-Identifier: MIT
#include "datasets/glassroom/replace_scene.h"

#include <catch2/catch.hpp>

#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr const char* kOlder =
    R"({"dataset": "glassroom", "files": {"intri.yml": "0", "images/0000/a.png": "0", "images/0001/a.png": "0", "../outside.txt": "0"}})";

struct TwoScenes {
  test::TempFolder place;
  fs::path folder = place.path() / "room", made = place.path() / ".room.part";

  TwoScenes() {
    for (const char* file : {"intri.yml", "images/0000/a.png", "images/0001/a.png", "notes.txt"})
      write_file(folder / file, "older");
    write_file(folder / "thesis/chapter.txt", "older");
    write_file(folder / "keys/data.json", "older");
    write_file(folder / "scene.json", kOlder);
    write_file(place.path() / "outside.txt", "older");
    for (const char* file : {"intri.yml", "images/0000/a.png", "gt/mesh.ply", "scene.json"})
      write_file(made / file, "made");
  }
  std::string in_folder(const char* file) const {
    return fs::exists(folder / file) ? read_file(folder / file) : "none";
  }
};

}  // namespace

TEST_CASE("A scene takes the place of an older one, and what is not of it stays") {
  const TwoScenes scenes;
  SECTION("by the older one's list of files") {}
  SECTION("by the layout, where the list is damaged") {
    write_file(scenes.folder / "scene.json", std::string(kOlder).substr(0, 60));
  }
  SECTION("or of another type") {
    write_file(scenes.folder / "scene.json", R"({"dataset": "glassroom", "files": [3]})");
  }
  replace_scene(scenes.made, scenes.folder);
  for (const char* file : {"intri.yml", "images/0000/a.png", "gt/mesh.ply", "scene.json"})
    CHECK(scenes.in_folder(file) == "made");
  for (const char* file : {"images/0001/a.png", "keys/data.json"})
    CHECK(scenes.in_folder(file) == "none");
  CHECK_FALSE(fs::exists(scenes.folder / "images/0001"));  // no empty folders
  for (const char* file : {"notes.txt", "thesis/chapter.txt"})
    CHECK(scenes.in_folder(file) == "older");
  CHECK(read_file(scenes.place.path() / "outside.txt") == "older");
}

TEST_CASE("Where nothing was, a scene is one rename") {
  const TwoScenes scenes;
  const fs::path fresh = scenes.place.path() / "fresh";
  SECTION("no folder") {}
  SECTION("an empty one") { fs::create_directories(fresh); }
  replace_scene(scenes.made, fresh);
  CHECK(read_file(fresh / "gt/mesh.ply") == "made");
  CHECK_FALSE(fs::exists(scenes.made));
}

TEST_CASE("A file of others where a folder has to be is an error with its name, and nothing changes"
) {
  const TwoScenes scenes;
  write_file(scenes.folder / "gt", "a file where a folder has to be");
  CHECK_THROWS_WITH(
      replace_scene(scenes.made, scenes.folder),
      Catch::Contains("gt: was put there by somebody else")
  );
  for (const char* file : {"intri.yml", "images/0001/a.png"})
    CHECK(scenes.in_folder(file) == "older");
  CHECK(scenes.in_folder("scene.json") == kOlder);
  CHECK(scenes.in_folder("notes.txt") == "older");
}
