// SPDX-License-Identifier: MIT
// Ways in for bytes of others, each a file NAME_fuzz.cpp that says
//
//   GLINT_REGISTER(FuzzTarget, {"png", read, seeds})
//
// libFuzzer runs them (scripts/fuzz.sh), and every build replays their seeds, the corpus, and both
// damaged (ctest -R '^fuzz/'). Refusing bytes by an Error that names the file is right; any other
// exception, a crash, more memory or time than the bytes are worth is a finding.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/files.h"
#include "glint/core/image.h"
#include "glint/core/registry.h"

namespace glint::fuzz {

struct FuzzInput {
  std::string name, bytes;
};

struct FuzzTarget {
  std::string id;
  bool (*read)(std::string_view bytes);  // whether it takes them; by accepts()
  std::vector<FuzzInput> (*seeds)();     // that it takes, small ones
  std::string source = {};
};

// A folder of this process's own, in memory where there is /dev/shm. Its name is in every message.
const fs::path& input_folder();
// The bytes as a file there, over what it held.
fs::path input_file(std::string_view bytes, const fs::path& name);
// What `write` puts into a file of that name.
FuzzInput written(const std::string& name, const std::function<void(const fs::path&)>& write);

// For seeds: values from 0 to 1.
Image ramp(int width, int height, int channels);

// Runs a reader. Whether it took the bytes; refusing them by an Error is fine. Throws Finding: the
// message does not name the input, or is longer than people read; memory ran out.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};
bool accepts(const std::function<void()>& read);

// What the target does with the bytes; `finding` empty: nothing wrong.
struct Outcome {
  bool accepted = false;
  std::string finding;
};
Outcome outcome_of(const FuzzTarget& target, std::string_view bytes);

// Damaged copies: cut off at 16 lengths, 400 with bytes changed; the same ones every time.
std::vector<std::string> damaged(std::string_view bytes);

}  // namespace glint::fuzz
