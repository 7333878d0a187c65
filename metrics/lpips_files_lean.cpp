// SPDX-License-Identifier: MIT
// In place of files of LPIPS weights, whose networks need oneDNN: this build never has any.
#include "glint/core/error.h"
#include "metrics/lpips_weights.h"

namespace glint {

LpipsWeights load_lpips_weights(const fs::path& path) {
  throw Error(
      ExitCode::kEnvironment,
      fmt::format("{}: LPIPS needs the full build; this is a lean one", path.string())
  );
}

fs::path lpips_weights_place() { return {}; }

std::shared_ptr<const LpipsWeights> lpips_weights_at(const fs::path&, std::string) {
  return nullptr;
}

}  // namespace glint
