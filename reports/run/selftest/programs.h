// SPDX-License-Identifier: MIT
// The programs that score files, called inside this process by their command lines.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/error.h"

namespace glint {

struct ProgramResult {
  ExitCode exit_code = ExitCode::kSuccess;
  std::map<std::string, double> values;  // metric id -> mean over the images
  std::string message;                   // of a failure
};

// `arguments`: the program's name ("glint-psnr", ..., "glint-mesh", or "glint-bench" "eval"
// "--predictions" P "--dataset" D), then its arguments.
ProgramResult run_scorer(const std::vector<std::string>& arguments);

}  // namespace glint
