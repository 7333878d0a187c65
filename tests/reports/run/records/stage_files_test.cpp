// SPDX-License-Identifier: MIT
// What a stage says of its files, and what is found when they are others.
#include <catch2/catch.hpp>

#include "glint/core/sha256.h"
#include "reports/run/records/stage_files.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

struct RenderedRun : test::TempFolder {
  RenderedRun() {
    write_file(path() / "renders/0000/rgb.exr", "picture");
    write_file(path() / "strip.png", "strip");
    write_stage(path(), Stage::kRender, {{"seed", 3}}, {"renders", "strip.png"});
  }
  std::vector<std::string> changes() const {
    return changed_files(path(), *read_stage(path(), Stage::kRender));
  }
  void edit_stage(const std::function<void(Json&)>& edit) const {
    Json json = read_json_object(path() / "keys/render.json");
    edit(json);
    write_file(path() / "keys/render.json", json.dump());
  }
};

}  // namespace

TEST_CASE("a stage knows its files by their bytes") {
  const RenderedRun run;
  const auto stage = read_stage(run.path(), Stage::kRender);
  REQUIRE(stage.has_value());
  CHECK(stage->files.at("strip.png") == 5);
  CHECK(stage->hashes.at("renders/0000/rgb.exr") == sha256("picture"));
  CHECK(run.changes().empty());
}

TEST_CASE("a file of the same size and other bytes has changed, and is not damaged") {
  const RenderedRun run;
  write_file(run / "renders/0000/rgb.exr", "PICTURE");
  CHECK(run.changes() == std::vector<std::string>{"renders/0000/rgb.exr has other bytes"});
  CHECK(what_is_damaged(run.path(), *read_stage(run.path(), Stage::kRender)).empty());
}

TEST_CASE("files that are missing or of another size have changed") {
  const RenderedRun run;
  fs::remove(run / "renders/0000/rgb.exr");
  write_file(run / "strip.png", "longer strip");
  const std::vector<std::string> changes = run.changes();
  REQUIRE(changes.size() == 2);
  CHECK(changes[0] == "renders/0000/rgb.exr is missing");
  CHECK(changes[1] == "strip.png has 12 bytes, had 5");
}

TEST_CASE("a stage of an earlier version has no hashes: its files go by their sizes") {
  const RenderedRun run;
  run.edit_stage([](Json& json) { json.erase("sha256"); });
  REQUIRE(read_stage(run.path(), Stage::kRender).has_value());
  write_file(run / "strip.png", "STRIP");
  CHECK(run.changes().empty());
  write_file(run / "strip.png", "");
  CHECK(run.changes().size() == 1);
}

TEST_CASE("a stage whose document was edited is none, and says why") {
  const RenderedRun run;
  CHECK(why_unreadable(run.path(), Stage::kRender).empty());
  CHECK(why_unreadable(run.path(), Stage::kMesh).empty());  // not there
  run.edit_stage([](Json& json) { json["made_from"]["seed"] = 4; });
  CHECK_FALSE(read_stage(run.path(), Stage::kRender).has_value());
  CHECK(
      why_unreadable(run.path(), Stage::kRender).find("is not that of its document") !=
      std::string::npos
  );
  write_file(run / "keys/render.json", "{");
  CHECK(why_unreadable(run.path(), Stage::kRender) == "damaged");
}

TEST_CASE("photos behind a link count, and a link in a circle is an error") {
  const test::TempFolder place;
  const fs::path data = place / "data", photos = place / "photos", cache = place / "hashes";
  write_file(data / "transforms.json", "{}");
  write_file(photos / "1.png", "a");
  fs::create_directory_symlink(photos, data / "images");
  const std::string before = content_hash(data, cache);
  write_file(photos / "1.png", "b");
  CHECK(content_hash(data, cache) != before);
  fs::create_directory_symlink(data, photos / "back");
  CHECK_THROWS_WITH(content_hash(data, cache), Catch::Contains("leads back to a folder around it"));
}
