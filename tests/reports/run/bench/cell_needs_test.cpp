// SPDX-License-Identifier: MIT
#include "reports/run/bench/cell_needs.h"

#include <catch2/catch.hpp>

#include "glint/core/machine.h"
#include "reports/run/bench/runner.h"
#include "tests/reports/fake_method.h"
#include "tests/support/small_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;

TEST_CASE("the images of a scene count as they lie in memory") {
  // Four views of 16x12 with an image of three and a map of one channel.
  const SceneSize size = size_of(fake_scene("room_1"));
  CHECK(size.image_bytes == 4 * 16 * 12 * (3 + 1) * 4);
  CHECK(size.view_pixels == 16 * 12);
  CHECK(size.resolution == "16x12");
}

TEST_CASE("a room that is not made yet counts as it will be loaded") {
  SceneSource source;
  source.scene = "room_1";
  source.width = 64, source.height = 36, source.views = 16;
  const SceneSize expected = size_of(source), loaded = size_of(test::small_room());
  CHECK(expected.image_bytes == Approx(loaded.image_bytes).epsilon(0.15));  // not all maps are kept
  CHECK(expected.view_pixels == loaded.view_pixels);
  CHECK(expected.resolution == loaded.resolution);
  source.scene = "nested_1";  // with maps of every layer and path
  CHECK(size_of(source).image_bytes > 2 * loaded.image_bytes);
}

TEST_CASE("what cells of a method took goes before what images and surfels say") {
  const SceneSize scene = size_of(fake_scene("room_1"));
  const Estimate unknown = estimate_memory({"fake", 1000, 0}, scene, {});
  CHECK(unknown.from == "its images and surfels");
  Record record;
  record.cell = {"room_9", "fake", 3};
  record.resolution = "16x12";
  record.metrics["peak-memory"] = 2000;
  CHECK(estimate_memory({"fake", 1000, 0}, scene, {record}).bytes == 2e9);
  CHECK(estimate_memory({"other", 1000, 0}, scene, {record}).bytes == unknown.bytes);
  record.resolution = "32x24";
  CHECK(estimate_memory({"fake", 1000, 0}, scene, {record}).bytes == unknown.bytes);
}

TEST_CASE("a process has more of a card than its training has in use") {
  const SceneSize scene = size_of(fake_scene("room_1"));
  const double few = estimate_device_bytes({"fake", 100, 0}, scene);
  CHECK(few > scene.image_bytes);
  CHECK(device_bytes_of_process(few) > few + 100e6);  // a context
}

TEST_CASE("more surfels and larger images take more, up to the limit of the method") {
  SceneSize scene = size_of(fake_scene("room_1"));
  const double few = estimate_memory({"fake", 1000000, 0}, scene, {}).bytes;
  scene.points = 100000;
  const double many = estimate_memory({"fake", 1000000, 0}, scene, {}).bytes;
  CHECK(many > few + 3 * 100000 * 4 * 58 * 4);
  CHECK(estimate_memory({"fake", 10, 0}, scene, {}).bytes < few);
}

TEST_CASE("the samples of meshes count where they take more than the training") {
  const SceneSize scene = size_of(fake_scene("room_1"));
  const Estimate sampled = estimate_memory({"fake", 1000, 1000000}, scene, {});
  CHECK(sampled.from == "its images and the samples of meshes");
  CHECK(sampled.bytes > estimate_memory({"fake", 1000, 0}, scene, {}).bytes);
}

TEST_CASE("the fusion of meshes counts where it takes most: with the square of the voxels") {
  const SceneSize scene = size_of(fake_scene("room_1"));
  const Estimate coarse = estimate_memory({"fake", 1000, 0, 0.02}, scene, {});
  const Estimate fine = estimate_memory({"fake", 1000, 0, 0.01}, scene, {});
  CHECK(coarse.from == "its images and the fusion of meshes");
  CHECK(coarse.bytes == Approx(750e6).epsilon(0.1));  // 720 to 814 MB were taken with 128x72 pixels
  CHECK(fine.bytes > 3.5 * coarse.bytes);
  CHECK(estimate_memory({"fake", 1000, 0}, scene, {}).bytes < coarse.bytes / 2);
}

TEST_CASE("a cell that does not fit says so before its training") {
  CHECK_NOTHROW(check_fits({1e9, "x"}, 1000000000));
  CHECK_THROWS_WITH(
      check_fits({3e9, "its images and surfels"}, 1 << 30),
      Catch::Contains("needs about 2.79 GiB (by its images and surfels), 1.00 GiB are free")
  );
  const test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  options.filter.only = {"room_1/fake/0"};
  Record before;  // of another seed: a cell that took more than there is
  before.cell = {"room_1", "fake", 7};
  before.resolution = "16x12";
  before.metrics["peak-memory"] = 1e9;
  append_record(folder.path() / "records.jsonl", before);
  const int trainings = FakeMethod::trainings;
  CHECK(run_profile(options).failed == 1);
  CHECK(FakeMethod::trainings == trainings);
  const auto records = read_records(folder.path() / "records.jsonl");
  const Record* record = find_record(records, {"room_1", "fake", 0});
  REQUIRE(record);
  CHECK(record->failure->kind == "out-of-memory");
  CHECK(record->estimated_memory_mb == 1e9);
}

TEST_CASE("this machine has memory that may be taken") {
  CHECK(available_memory_bytes() > 1000000);
  CHECK(available_memory_bytes() <= this_machine().memory_bytes);
  CHECK(resident_memory_bytes() > 1000000);
}

TEST_CASE("a setting that asks for memory by its number is what the estimate goes by") {
  SceneSize scene = size_of(fake_scene("room_1"));
  MemoryUser user{"fake", 1000, 0};
  const Estimate usual = estimate_memory(user, scene, {});
  user.config = {{"map_height", 4096}, {"map_channels", 16}};
  const Estimate map = estimate_memory(user, scene, {});
  CHECK(map.from == "map_height = 4096");
  CHECK(map.bytes > 4096.0 * 8192 * 16 * 4 * 4);  // values, gradients and two moments
  user.config = {{"random_points", 1000000000}};
  scene.points = 0;
  CHECK(estimate_memory(user, scene, {}).from == "random_points = 1000000000");
  scene.points = 1;  // then none are drawn
  CHECK(estimate_memory(user, scene, {}).from == usual.from);
  CHECK_THROWS_AS(check_fits({1e12, "map_height = 8192"}, 1000), OutOfMemory);
}
