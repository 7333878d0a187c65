// SPDX-License-Identifier: MIT
// Arrays in one file, and what lies in such files: packed scenes.
#include "datasets/packed_scene.h"
#include "glint/scene/safetensors.h"
#include "tests/fuzz/fuzz_seeds.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/mended_safetensors.h"

namespace glint::fuzz {
namespace {

bool read(std::string_view bytes) {
  const fs::path path = input_file(bytes, "input.safetensors");
  return accepts([&] {
    SafetensorsFile file(path);
    for (const std::string& name : file.names()) {
      std::vector<std::byte> values(file.find(name)->num_bytes());
      file.read_bytes(name, values);
    }
  });
}

std::vector<FuzzInput> seeds() {
  const auto zeros = [](std::size_t bytes) {
    return [bytes](std::byte* to) { std::fill_n(to, bytes, std::byte{0}); };
  };
  return {written("arrays", [&](const fs::path& path) {
    write_safetensors(
        path,
        {{"format", "test"}},
        {{"a", {TensorType::kF32, {2, 3}}, zeros(24)},
         {"b", {TensorType::kU8, {5}}, zeros(5)},
         {"none", {TensorType::kF64, {0, 4}}, zeros(0)}}
    );
  })};
}

bool read_scene_file(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.safetensors"), again = input_folder() / "again";
  return accepts([&] {
    const Scene scene = read_packed_scene(file);
    write_packed_scene(again, scene);
    if (read_packed_scene(again).train.size() != scene.train.size())
      throw Finding("a packed scene that is another one when it is packed again");
  });
}

bool read_scene(std::string_view bytes) {
  const std::string mended = mended_safetensors(bytes);
  const bool taken = read_scene_file(bytes);
  return (mended != bytes && read_scene_file(mended)) || taken;
}

std::vector<FuzzInput> scene_seeds() {
  return {written("scene", [](const fs::path& path) { write_packed_scene(path, tiny_scene()); })};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"safetensors", read, seeds})
GLINT_REGISTER(FuzzTarget, {"packed_scene", read_scene, scene_seeds})

}  // namespace glint::fuzz
