// SPDX-License-Identifier: MIT
// Linked with packed scenes and what they need, nothing else: that this program can be built says
// that a packed scene is read without any image library.
#include <cstdio>

#include "datasets/packed_scene.h"
#include "glint/core/error.h"

using namespace glint;

int main() {
  const fs::path file = fs::temp_directory_path() / "glint_packed_alone.safetensors";
  try {
    Scene scene;
    scene.name = "alone";
    scene.train.resize(1);
    scene.train[0].name = "0";
    scene.train[0].camera = look_at({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {4, 3}, 60);
    scene.train[0].rgb = Image(4, 3, 3, 0.25f);
    write_packed_scene(file, scene);
    const Scene read = read_packed_scene(file);
    fs::remove(file);
    return read.train.at(0).rgb.at(3, 2, 1) == 0.25f ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
