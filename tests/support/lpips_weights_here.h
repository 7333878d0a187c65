// SPDX-License-Identifier: MIT
// Random weights of AlexNet, where the loss looks for them, while this lives.
#pragma once

#include <cstdlib>

#include "tests/metrics/tiny_lpips.h"
#include "tests/support/temp_folder.h"

namespace glint::test {

struct LpipsWeightsHere {
  TempFolder folder;
  LpipsWeightsHere() {
    write_weights(folder / "lpips_alex_v0.1.safetensors", random_arrays(lpips_networks()[0]));
    ::setenv("GLINT_LPIPS_WEIGHTS", folder.path().c_str(), 1);
  }
  ~LpipsWeightsHere() { ::unsetenv("GLINT_LPIPS_WEIGHTS"); }
};

}  // namespace glint::test
