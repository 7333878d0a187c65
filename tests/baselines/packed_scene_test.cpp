// SPDX-License-Identifier: MIT
// Training does not see whether its scene came from a folder or from a packed file.
#include "datasets/packed_scene.h"

#include <catch2/catch.hpp>

#include "glint/method.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

// What the method saves after five steps, by file.
std::map<std::string, std::string> saved_after_five_steps(
    const std::string& id, const Scene& scene
) {
  const auto method = create_method(id);
  RunOptions options;
  options.iterations = 5;
  method->initialize(scene, options);
  for (int i = 0; i < 5; ++i) method->step(i);
  const TempFolder folder;
  method->save(folder.path().string());
  std::map<std::string, std::string> files;
  for (const fs::path& file : list_files(folder.path()))
    files[file.filename().string()] = read_file(file);
  return files;
}

}  // namespace

TEST_CASE("five steps on a packed scene give the bytes that five steps on its folder give") {
  const TempFolder folder;
  write_packed_scene(folder / "room.safetensors", small_room());
  const Scene packed = load_scene(folder / "room.safetensors", {});
  for (const char* id : {"2dgs", "glint"}) {
    INFO(id);
    const auto files = saved_after_five_steps(id, small_room());
    CHECK(files.contains("interface.ply"));
    CHECK(saved_after_five_steps(id, packed) == files);
  }
}
