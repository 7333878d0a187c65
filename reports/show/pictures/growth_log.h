// SPDX-License-Identifier: MIT
// How the surfels and the quality of a training grew, from its log.jsonl.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

struct Course {
  std::vector<double> x, y;  // steps done, value
};

struct GrowthLog {
  int steps = 0;  // done at its last line
  Course surfels, psnr, test_psnr;
  std::map<std::string, Course> sets;  // surfels of each, of methods with several
};

// Counts of lines that lie close are thinned, PSNR of training views, each of another view, is
// averaged over parts of the training. Torn lines are skipped; no log is one without lines.
GrowthLog read_growth_log(const fs::path& log);

}  // namespace glint
