// SPDX-License-Identifier: MIT
// Every method goes on from a checkpoint as if it had never stopped.
#include "glint/train/checkpoint.h"

#include <catch2/catch.hpp>

#include "glint/method.h"
#include "tests/support/all_trained.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kSteps = 24;  // all phases of a run, scaled to it

Scene few_views() {
  Scene scene = small_room();
  scene.train.resize(5);
  return scene;
}

// What a method is after all steps; it writes a checkpoint before each step of `stops`.
std::string train_through(
    const std::string& id, const Scene& scene, const std::vector<int>& stops, const fs::path& folder
) {
  const auto method = create_method(id);
  method->initialize(scene, {kSteps, 3});
  for (int i = 0; i < kSteps; ++i) {
    if (std::find(stops.begin(), stops.end(), i) != stops.end())
      REQUIRE(write_checkpoint(folder / std::to_string(i), "run", *method, {.iterations = i}));
    method->step(i);
  }
  return saved_bytes(*method);
}
std::string train_from(const std::string& id, const Scene& scene, const fs::path& checkpoint) {
  const auto method = create_method(id);
  method->initialize(scene, {kSteps, 3});
  TrainingProgress done;
  read_checkpoint(checkpoint, *method, done);
  for (int i = done.iterations; i < kSteps; ++i) method->step(i);
  return saved_bytes(*method);
}

}  // namespace

TEST_CASE("A training that goes on ends with the same bytes, whatever the method") {
  const Scene scene = few_views();
  int shift = 0;  // another place for every method
  for (const std::string& id : all_trained()) {
    const TempFolder folder;
    const std::vector<int> stops{1 + shift % 10, 11 + shift % 12};
    shift += 5;
    const std::string expected = train_through(id, scene, stops, folder.path());
    for (const int stop : stops) {
      INFO(id << " from step " << stop);
      CHECK((train_from(id, scene, folder.path() / std::to_string(stop)) == expected));
    }
  }
}

TEST_CASE("Checkpoints of a GPU are those of its memory") {
  const OnHost on_host;
  watch_memory(false);
  Scene scene = few_views();
  const TempFolder folder;
  const std::string expected = train_through("2dgs", scene, {15}, folder.path());
  CHECK((train_from("2dgs", scene, folder.path() / "15") == expected));
}

TEST_CASE("A checkpoint that is damaged or of another run says what is wrong") {
  const Scene scene = few_views();
  const TempFolder folder;
  const fs::path file = folder.path() / "checkpoint.safetensors";
  const auto method = create_method("2dgs"), other = create_method("envgs");
  method->initialize(scene, {kSteps, 3});
  other->initialize(scene, {kSteps, 3});
  REQUIRE(write_checkpoint(file, "run", *method, {}));
  CHECK(is_checkpoint_of(file, "run"));
  CHECK(!is_checkpoint_of(file, "another run"));
  CHECK(!is_checkpoint_of(folder.path() / "none", "run"));
  TrainingProgress done;
  CHECK_THROWS_WITH(
      read_checkpoint(file, *other, done),
      Catch::Contains("bootstrap.rng.state is not in its metadata")
  );
  const std::string bytes = read_file(file);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = bytes;
    const std::size_t at = changed.find(from);
    REQUIRE(at != std::string::npos);
    REQUIRE(from.size() == to.size());
    changed.replace(at, from.size(), to);
    write_file(file, changed);
    const auto reader = create_method("2dgs");
    reader->initialize(scene, {kSteps, 3});
    read_checkpoint(file, *reader, done);
  };
  CHECK_THROWS_WITH(
      with(R"("interface.adam.steps":"0")", R"("interface.adam.steps":"x")"),
      Catch::Contains("interface.adam.steps is 'x', which is no such number")
  );
  CHECK_THROWS_WITH(
      with(
          R"("interface.cloud.means":{"dtype":"F32")", R"("interface.cloud.means":{"dtype":"U32")"
      ),
      Catch::Contains("interface.cloud.means is U32")
  );
}
