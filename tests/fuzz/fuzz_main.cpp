// SPDX-License-Identifier: MIT
// The fuzzer of the target that the program's name ends in: fuzz-png (preset fuzz,
// scripts/fuzz.sh).
#include <cstdio>
#include <cstdlib>

#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "tests/fuzz/fuzz_target.h"

using namespace glint;
using namespace glint::fuzz;

namespace {
const FuzzTarget* target = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int*, char*** argv) {
  const std::string name = fs::path((*argv)[0]).filename().string();
  const auto& all = Registry<FuzzTarget>::all();
  const auto it = all.find(name.substr(name.find('-') + 1));
  if (it == all.end()) {
    std::fprintf(stderr, "%s: call me by a link fuzz-TARGET (test_fuzz --list)\n", name.c_str());
    std::exit(static_cast<int>(ExitCode::kUsage));
  }
  target = &it->second;
  set_quiet(true);
  set_num_threads(1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  target->read({reinterpret_cast<const char*>(data), size});
  return 0;
}
