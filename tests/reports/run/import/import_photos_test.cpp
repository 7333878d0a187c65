// SPDX-License-Identifier: MIT
// A stand-in for COLMAP says what COLMAP says and leaves a model that the test wrote.
#include "reports/run/import/import_photos.h"

#include <cstdlib>

#include "datasets/colmap_model.h"
#include "datasets/dataset.h"
#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "tests/reports/run_words.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

// PATH with a folder in front, as long as this lives.
class PathInFront {
 public:
  explicit PathInFront(const fs::path& folder) : before_(std::getenv("PATH")) {
    ::setenv("PATH", (folder.string() + ":" + before_).c_str(), 1);
  }
  ~PathInFront() { ::setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

void write_program(const fs::path& path, const std::string& text) {
  write_file(path, "#!/bin/sh\n" + text);
  fs::permissions(path, fs::perms::owner_all);
}

// Photos p0.png ... in folders, and a model of the first `posed` of them.
void write_photos(const fs::path& folder, int count) {
  for (int i = 0; i < count; ++i) {
    Image photo(32, 24, 3);
    photo.at(i, i, 0) = 1;
    write_png(folder / ("day/p" + std::to_string(i) + ".png"), photo);
  }
}
void write_model(const fs::path& folder, int posed) {
  ColmapModel model;
  model.cameras[1] = {4, 32, 24, {30, 30, 16, 12, 0.01, 0, 0, 0}};
  for (int i = 0; i < posed; ++i) {
    ColmapImage image;
    image.id = static_cast<std::uint32_t>(i + 1);
    image.camera_id = 1;
    image.name = "day/p" + std::to_string(i) + ".png";
    image.translation_cam_from_world = {0.1 * i, 0, 0};
    model.images.push_back(image);
  }
  PointCloud points;
  for (int i = 0; i < 8; ++i) {
    points.positions.push_back({0.2f * static_cast<float>(i % 4) - 0.3f, 0.1f, 2.0f});
    points.colors.push_back({0.5f, 0.5f, 0.5f});
  }
  write_colmap_model(folder, model, points);
}

// Its first model is the smaller one. `mapper`: commands in front of it.
void write_colmap(const TempFolder& folder, int posed, const std::string& mapper = "") {
  write_model(folder / "model", posed);
  write_model(folder / "smaller", posed - 1);
  write_program(
      folder / "bin/colmap",
      "echo \"$@\" >>" + (folder / "calls").string() +
          "\n"
          "case $2 in -h) echo '  --SiftExtraction.use_gpu'; exit 0 ;; esac\n"
          "while [ $# -gt 1 ]; do case $1 in --output_path) out=$2 ;; mapper) mapper=1 ;; esac; "
          "shift; done\n"
          "echo 'Processed file [1/4]'; echo 'Registering image #3 (3)'\n"
          "[ \"$mapper\" ] || exit 0\n" +
          mapper + "\ncp -r " + (folder / "smaller").string() + " $out/0\ncp -r " +
          (folder / "model").string() + " $out/1\n"
  );
}

}  // namespace

TEST_CASE("photos become a folder that loads, checks and says what was left out") {
  const TempFolder folder;
  write_photos(folder / "photos", 5);
  write_colmap(folder, 4);
  const PathInFront path(folder / "bin");
  const std::string out = folder / "out";
  std::string said;
  const std::vector<std::string> words{
      "dataset", "import", folder / "photos", "--out", out, "--json", "--quiet"};
  said = captured(1, [&] { CHECK(run(words) == 0); });
  const Json json = Json::parse(said);
  CHECK(json.at("photos") == 5);
  CHECK(json.at("points") == 8);
  CHECK(json.at("other_models") == 1);
  CHECK(json.at("matcher") == "exhaustive");
  CHECK(json.at("unposed") == Json({"day/p4.png"}));
  CHECK_FALSE(fs::exists(out + ".colmap"));
  CHECK(check_dataset(out).empty());
  const Scene scene = load_scene(out, {});
  CHECK(scene.train.size() + scene.test.size() == 4);
  const std::string calls = read_file(folder / "calls");
  CHECK_THAT(calls, Contains("--ImageReader.single_camera 1"));
  CHECK_THAT(calls, Contains("--SiftExtraction.max_image_size 1600"));
  CHECK(run(words) == 1);  // there is something now
}

TEST_CASE("masks of photos go to COLMAP under its names, and into the folder") {
  const TempFolder folder;
  write_photos(folder / "photos", 5);
  write_colmap(folder, 4);
  const PathInFront path(folder / "bin");
  Image mask(32, 24, 1, 1.0f);
  for (int i = 0; i < 25; ++i) mask.at(8 + i % 5, 8 + i / 5) = 0;
  PhotoOptions options;
  options.masks = folder / "photos/masks";  // no photos themselves
  fs::create_directory(options.masks);
  CHECK_THAT(
      bad_reference([&] { import_photos(folder / "photos", folder / "out", options); }),
      Contains("masks: no mask of any photo") && Contains("day/p0.png")
  );
  write_png(folder / "photos/masks/day/p1.png", mask);
  write_png(folder / "photos/masks/day/p2.png.png", mask);
  write_png(folder / "photos/masks/day/p4.png", mask);  // gets no camera
  CHECK(import_photos(folder / "photos", folder / "out", options).masks == 2);
  CHECK_THAT(read_file(folder / "calls"), Contains("--ImageReader.mask_path"));
  CHECK(check_dataset(folder / "out").empty());
  const Scene scene = load_scene(folder / "out", {});
  REQUIRE(scene.train.size() == 3);  // p0 is a test view
  CHECK(scene.train[0].counted.at(10, 10) == 0);
  CHECK(scene.train[1].counted.at(10, 10) == 0);
  CHECK(scene.train[2].counted.empty());
}

TEST_CASE("what COLMAP says when it fails is shown, and its work is gone on from") {
  const TempFolder folder;
  write_photos(folder / "photos", 4);
  write_colmap(
      folder, 3, "[ -e " + (folder / "mended").string() + " ] || { echo 'no good pair'; exit 3; }"
  );
  const PathInFront path(folder / "bin");
  const fs::path out = folder / "out";
  const std::string message =
      error_of(ExitCode::kEnvironment, [&] { import_photos(folder / "photos", out, {}); });
  CHECK_THAT(message, Contains("colmap mapper ended with exit code 3") && Contains("no good pair"));
  CHECK(fs::exists(folder / "out.colmap/colmap.log"));
  CHECK_FALSE(fs::exists(out));
  write_file(folder / "mended", "");
  CHECK(import_photos(folder / "photos", out, {}).unposed.size() == 1);
}

TEST_CASE("too few photos, models without them, and no COLMAP have messages of their own") {
  const TempFolder folder;
  write_photos(folder / "photos", 2);
  CHECK_THAT(
      bad_reference([&] { import_photos(folder / "photos", folder / "out", {}); }),
      Contains("2 photos") && Contains("at least 3")
  );
  CHECK_THAT(
      bad_reference([&] { import_photos(folder / "none", folder / "out", {}); }),
      Contains("no such folder")
  );
  write_photos(folder / "photos", 4);
  write_colmap(folder, 2);
  {
    const PathInFront path(folder / "bin");
    CHECK_THAT(
        bad_reference([&] { import_photos(folder / "photos", folder / "out", {}); }),
        Contains("found no place for 3 photos together")
    );
  }
  write_program(folder / "without/env", "exit 127\n");
  const PathInFront path(folder / "without");
  CHECK_THAT(
      error_of(
          ExitCode::kEnvironment, [&] { import_photos(folder / "photos", folder / "out", {}); }
      ),
      Contains("apt-get install colmap")
  );
}
