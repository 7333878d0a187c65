// SPDX-License-Identifier: MIT
// Values of metrics as they were written against the same values computed again.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "reports/bench/stages.h"
#include "reports/provenance/checked.h"

namespace glint {

// What became of the values of one list.
struct ScoreComparison {
  int equal = 0;                            // to the last digit
  std::vector<std::string> rounded;         // differ as rounding does: "lpips 1e-09"
  std::vector<std::string> differing;       // "psnr 24.5, now 24.4"
  std::vector<std::string> not_recomputed;  // costs, what this program or machine cannot score
  std::vector<std::string> added;           // ids that this program has and that one had not

  void add(const ScoreComparison& other);  // of another list: a view's
};

// How exact they have to be, and which ids were known then.
struct ScoreRules {
  bool same_device = true;  // scored on the CPU then and now: image metrics are the same bytes
  Json protocols = Json::object();  // of metrics.json
};

// `then`: id -> value; null where it was not finite.
ScoreComparison compare_values(
    const Json& then, const std::map<std::string, double>& now, const ScoreRules& rules
);

// metrics.json against the scores of the same files: means and views by name.
ScoreComparison compare_scores(
    const Json& metrics_file,
    const RunScores& now,
    const std::vector<View>& views,
    const ScoreRules& rules
);

}  // namespace glint
