// SPDX-License-Identifier: MIT
// A training's state: what is read must let the training take its next step. The identity in the
// metadata says whose it is.
#include "glint/core/interrupt.h"
#include "glint/method.h"
#include "glint/train/checkpoint.h"
#include "tests/fuzz/fuzz_seeds.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/mended_safetensors.h"

namespace glint::fuzz {
namespace {

constexpr int kIterations = 100;
constexpr const char* kMethods[] = {"2dgs", "glint", "tsgs", "ref-gs"};  // all kinds of state

const Scene& scene() {
  static const Scene scene = tiny_scene();
  return scene;
}

std::unique_ptr<Method> started(const std::string& id) {
  auto method = create_method(id);
  method->initialize(scene(), {.iterations = kIterations});
  return method;
}

std::string method_of(const fs::path& file) {
  for (const char* id : kMethods)
    if (is_checkpoint_of(file, id)) return id;
  return kMethods[0];
}

bool read_state(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.safetensors");
  const auto method = started(method_of(file));
  TrainingProgress progress;
  const bool taken = accepts([&] { read_checkpoint(file, *method, progress); });
  if (!taken) return false;
  try {
    method->step(progress.iterations);
    method->check_finite();
  } catch (const Error&) {  // numbers that no training has are found by it
  }
  return true;
}

bool read(std::string_view bytes) {
  const std::string mended = mended_safetensors(bytes);
  const bool taken = read_state(bytes);
  return (mended != bytes && read_state(mended)) || taken;
}

FuzzInput seed_of(const std::string& id) {
  return written(id, [&](const fs::path& path) {
    const auto method = started(id);
    TrainingProgress progress;
    for (; progress.iterations < 3; ++progress.iterations) method->step(progress.iterations);
    write_checkpoint(path, id, *method, progress);
  });
}

std::vector<FuzzInput> seeds() {
  std::vector<FuzzInput> seeds;
  for (const char* id : kMethods) seeds.push_back(seed_of(id));
  return seeds;
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"checkpoint", read, seeds})

}  // namespace glint::fuzz
