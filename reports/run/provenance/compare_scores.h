// SPDX-License-Identifier: MIT
// metrics.json as it was written against the same files scored again.
#pragma once

#include <string>
#include <vector>

#include "glint/core/config.h"

namespace glint {

struct ScoreComparison {
  int equal = 0;                            // to the last digit
  std::vector<std::string> rounded;         // differ as other kernels round: "lpips 1e-09"
  std::vector<std::string> differing;       // "0001: psnr 24.5, now 24.4"
  std::vector<std::string> not_recomputed;  // costs, what this program or machine cannot score
  std::vector<std::string> added;           // ids that this program has and that one had not
};

// Means and views by name. `then` may lack what came later, as its protocols say.
ScoreComparison compare_scores(const Json& then, const Json& now);

}  // namespace glint
