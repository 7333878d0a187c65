// SPDX-License-Identifier: MIT
#include "reports/run/bench/path_frames.h"

#include <catch2/catch.hpp>

#include <cstdlib>

#include "glint/core/left_behind.h"
#include "glint/drawing/picture_grid.h"
#include "glint/scene/camera_path.h"
#include "glint/scene/image_files.h"
#include "reports/run/bench/video.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

PathFrames path_in(const fs::path& folder, const Scene& scene) {
  const Camera lens = scene.train.front().camera;
  const Orbit orbit{{0, 0, 0}, {0, 0, 1}, {0, 0, 1}, 2, {1, 0, 0}};
  return {folder, {orbit_cameras(orbit, lens, 3), 12}, {}, false};
}

// PATH for as long as this lives.
class SearchPath {
 public:
  explicit SearchPath(const std::string& path) : before_(std::getenv("PATH")) {
    ::setenv("PATH", path.c_str(), 1);
  }
  ~SearchPath() { ::setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

// A stand-in that writes its last word's file, or fails.
void install_ffmpeg(const fs::path& folder, const std::string& script) {
  write_file(folder / "ffmpeg", "#!/bin/sh\n" + script);
  fs::permissions(folder / "ffmpeg", fs::perms::owner_all);
}

}  // namespace

TEST_CASE("a path leaves a picture of each map and frame, the cameras, and all side by side") {
  const test::TempFolder folder;
  const SearchPath no_ffmpeg(folder.path().string());
  FakeMethod method(Json::object());
  const Scene scene = fake_scene("room");
  PathFrames options = path_in(folder / "orbit", scene);
  options.values = true;
  const PathResult result = render_path(method, scene, options);
  CHECK(result.frames == 3);
  CHECK(result.maps == std::vector<std::string>{"rgb", "depth", "transparency", "interface"});
  CHECK(result.no_video == "ffmpeg is not installed");
  CHECK(result.video.empty());
  for (const std::string& map : result.maps)
    for (const char* frame : {"0000.png", "0001.png", "0002.png"})
      CHECK(read_image_size(options.folder / map / frame) == scene.train[0].camera.size());
  CHECK(read_image(options.folder / "depth/0002.exr", 1).at(3, 3) == 2.0f);
  const ImageSize sheet = read_image_size(options.folder / "layers/0001.png");
  CHECK(sheet.width > 2 * kMinPanelWidth);
  CHECK(sheet.height > kMinPanelWidth / 2);
  CHECK(read_camera_path(options.folder / "path.json", {}).cameras.size() == 3);
}

TEST_CASE("the glass taken away is shown where maps tell, in the order that is asked for") {
  struct Pane : FakeMethod {
    using FakeMethod::FakeMethod;
    MapSet render(const Camera& camera) override {
      MapSet output = FakeMethod::render(camera);
      output["transparency"] = Image(camera.width, camera.height, 1, 1.0f);
      output["transmission"] = Image(camera.width, camera.height, 3, 0.25f);
      return output;
    }
  };
  const test::TempFolder folder;
  const SearchPath no_ffmpeg(folder.path().string());
  Pane method(Json::object());
  const Scene scene = fake_scene("room");
  PathFrames options = path_in(folder / "orbit", scene);
  CHECK(render_path(method, scene, options).maps.back() == "away");
  options.maps = {"away", "rgb"};
  CHECK(render_path(method, scene, options).maps == options.maps);
  CHECK(read_image(options.folder / "away/0001.png", 3).at(2, 2, 1) == Approx(0.25f).margin(0.01));
  options.maps = {"depth"};
  render_path(method, scene, options);
  CHECK(!fs::exists(options.folder / "away"));
}

TEST_CASE("chosen maps alone are rendered, over an earlier path, over nothing else") {
  const test::TempFolder folder;
  const SearchPath no_ffmpeg(folder.path().string());
  FakeMethod method(Json::object());
  const Scene scene = fake_scene("room");
  PathFrames options = path_in(folder / "orbit", scene);
  render_path(method, scene, options);
  write_file(options.folder / "notes.txt", "mine");
  options.maps = {"rgb"};
  options.path.cameras.pop_back();
  CHECK(render_path(method, scene, options).maps == options.maps);
  CHECK(!fs::exists(options.folder / "depth"));
  CHECK(!fs::exists(options.folder / "rgb/0002.png"));
  CHECK(fs::exists(options.folder / "notes.txt"));
  options.maps = {"dept"};
  CHECK_THROWS_WITH(render_path(method, scene, options), Catch::Contains("did you mean 'depth'?"));
  options.folder = folder / "photos";
  options.maps.clear();
  write_file(options.folder / "rgb/0000.png", "someone's");
  CHECK_THROWS_WITH(render_path(method, scene, options), Catch::Contains("no earlier path"));
  CHECK(read_file(options.folder / "rgb/0000.png") == "someone's");
}

TEST_CASE("no name of a folder is an option, a protocol or a pattern to ffmpeg") {
  for (const char* folder : {"-version", "http:x", "a%db", "$(reboot)"}) {
    const auto words = video_command(fs::path(folder) / "%04d.png", 24, fs::path(folder) / "v.mp4");
    INFO(folder);
    const std::string here = fs::current_path().string() + "/";
    const std::string name = folder == std::string("a%db") ? "a%%db" : folder;
    CHECK(*(std::find(words.begin(), words.end(), "-i") + 1) == here + name + "/%04d.png");
    CHECK(words.back() == here + folder + "/v.mp4");
  }
}

TEST_CASE("ffmpeg makes the video where it is installed, and may fail") {
  const test::TempFolder folder;
  const SearchPath own(folder.path().string() + ":/bin:/usr/bin");
  install_ffmpeg(folder.path(), "for last; do :; done\necho \"$@\" > \"$last\"\n");
  const fs::path video = folder / "layers.mp4";
  CHECK(write_video("layers/%04d.png", 12, video).empty());
  const std::string frames = (fs::current_path() / "layers/%04d.png").string();
  CHECK(read_file(video).find("-framerate 12 -i " + frames) != std::string::npos);
  fs::remove(video);
  // Under a name that `status --leftovers` knows until it is whole.
  const fs::path names = folder / "names";
  install_ffmpeg(
      folder.path(), "for last; do :; done\necho \"$last\" > " + names.string() + "\nexit 3\n"
  );
  write_video("layers/%04d.png", 12, video);
  CHECK(read_file(names) == unfinished_path(video).string() + "\n");
  install_ffmpeg(folder.path(), "exit 3\n");
  CHECK(write_video("layers/%04d.png", 12, video) == "ffmpeg ended with 3");
  CHECK(!fs::exists(video));
}
