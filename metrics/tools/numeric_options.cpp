// SPDX-License-Identifier: MIT
#include "metrics/tools/numeric_options.h"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdlib>

#include "glint/core/error.h"

namespace glint {

void check_numbers(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_type_name().starts_with("FLOAT")) continue;
    for (const std::string& text : option->results())
      GLINT_CHECK(
          std::isfinite(std::strtod(text.c_str(), nullptr)),
          kUsage,
          "{} is {}; expected a finite number",
          option->get_name(),
          text
      );
  }
  for (const CLI::App* verb : app.get_subcommands()) check_numbers(*verb);
}

}  // namespace glint
