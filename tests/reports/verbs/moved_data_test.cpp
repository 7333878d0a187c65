// SPDX-License-Identifier: MIT
// A run whose data have moved: `render`, `mesh` and `eval` take --dataset.
#include "tests/reports/run_words.h"

using namespace glint;
using test::run;

namespace {

void make_room(const std::string& scene, const std::string& to) {
  std::vector<std::string> words{"dataset", "make", "glassroom", "--scene", scene, "--out", to};
  words.insert(words.end(), {"--width", "32", "--height", "18", "--views", "4", "--spp", "2"});
  words.emplace_back("--quiet");
  REQUIRE(run(words) == 0);
}

}  // namespace

TEST_CASE("data that have moved are named with --dataset") {
  const test::TempFolder folder;
  const std::string room = folder / "room", moved = folder / "moved", trained = folder / "run";
  const auto render = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "--run", trained, "--quiet"});
    return run(more);
  };
  make_room("room_1", room);
  REQUIRE(
      run(
          {"train",
           "--dataset",
           room,
           "--run",
           trained,
           "--iterations",
           "2",
           "--data",
           (folder / "data").string(),
           "--quiet"}
      ) == 0
  );
  REQUIRE(render({}) == 0);
  fs::rename(room, moved);
  CHECK(render({}) == 3);
  CHECK(render({"--dataset", moved}) == 0);
  CHECK(run({"eval", "--run", trained, "--quiet"}) == 3);
  CHECK(run({"mesh", "--run", trained, "--quiet"}) == 3);
  CHECK(render({"--dataset", moved, "--path", "orbit", "--frames", "2"}) == 0);
  CHECK(fs::exists(fs::path(trained) / "paths/orbit/rgb/0001.png"));
  CHECK(render({"--dataset", moved, "--path", "spline", "--frames", "2", "--size", "20x10"}) == 0);
  const std::string file = (fs::path(trained) / "paths/orbit/path.json").string();
  CHECK(render({"--dataset", moved, "--path", file, "--to", (folder / "again").string()}) == 0);
  CHECK(render({"--dataset", moved, "--path", file, "--frames", "9"}) == 1);
  CHECK(render({"--dataset", moved, "--path", "orbit", "--size", "20"}) == 1);
  CHECK(render({"--dataset", moved, "--frames", "9"}) == 1);
  CHECK(render({"--dataset", moved, "--path", "orbitt"}) == 1);
}

TEST_CASE("a run is not scored against a scene of another name") {
  const test::TempFolder folder;
  const std::string room = folder / "room", other = folder / "other", trained = folder / "run";
  make_room("room_1", room);
  make_room("room_2", other);
  const std::string data = folder / "data";
  REQUIRE(
      run({"train", "--dataset", room, "--run", trained, "--iterations", "2", "--data", data}) == 0
  );
  REQUIRE(run({"render", "--run", trained, "--quiet"}) == 0);
  CHECK(run({"eval", "--run", trained, "--dataset", other, "--quiet"}) == 1);
  CHECK_FALSE(fs::exists(fs::path(trained) / "metrics.json"));
}
