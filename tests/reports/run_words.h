// SPDX-License-Identifier: MIT
// glint-bench inside of a test: its exit code.
#pragma once

#include <string>
#include <vector>

#include "reports/verbs/command_line.h"
#include "tests/support/captured.h"

namespace glint::test {

inline int run(const std::vector<std::string>& words) {
  std::vector<const char*> arguments{"glint-bench"};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  return run_command_line(static_cast<int>(arguments.size()), arguments.data());
}

}  // namespace glint::test
