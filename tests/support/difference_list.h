// SPDX-License-Identifier: MIT
// What tests of GPU backends found, whether they passed or not, for who reads them: a line each in
// the file that GLINT_DIFFERENCES names.
#pragma once

#include <cstdlib>
#include <string>

#include "glint/core/files.h"

namespace glint::test {

inline void list_difference(
    const std::string& test,
    const std::string& backend,
    const std::string& array,
    double found,
    double tolerance
) {
  const char* file = std::getenv("GLINT_DIFFERENCES");
  if (file == nullptr) return;
  append_line(
      file, fmt::format("{:.1e}\t{:.1e}\t{}\t{}\t{}", found, tolerance, backend, test, array)
  );
}

}  // namespace glint::test
