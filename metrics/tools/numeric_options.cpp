// SPDX-License-Identifier: MIT
#include "metrics/tools/numeric_options.h"

#include <CLI/CLI.hpp>

#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "glint/core/error.h"

namespace glint {
namespace {

// `name`: of the check in help. CLI11 puts the option's name in front of the message.
CLI::Validator number_check(const char* name, const char* expected, bool (*holds)(double)) {
  const auto check = [=](const std::string& text) -> std::string {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool is_number = end != text.c_str() && *end == '\0';
    return is_number && holds(value) ? "" : fmt::format("'{}' must be {}", text, expected);
  };
  return CLI::Validator(check, name);
}

void check_float(const CLI::Option& option, const std::string& text) {
  GLINT_CHECK(
      !text.empty() && std::isfinite(std::strtod(text.c_str(), nullptr)),
      kUsage,
      "{} is {}; expected a finite number",
      option.get_name(),
      text.empty() ? "empty" : text
  );
}

// A seed may be any number; what counts something may not be more than anything that is counted.
std::uint64_t most_of(const CLI::Option& option) {
  constexpr std::uint64_t kMostCounted = 1000000000;
  const bool is_seed = option.get_name() == "--seed";
  return is_seed ? std::numeric_limits<std::uint64_t>::max() : kMostCounted;
}

void check_unsigned(const CLI::Option& option, const std::string& text) {
  errno = 0;
  const std::uint64_t value = std::strtoull(text.c_str(), nullptr, 0);
  GLINT_CHECK(
      !text.empty() && errno != ERANGE && text.find('-') == std::string::npos &&
          value <= most_of(option),
      kUsage,
      "{} is {}; expected a whole number from 0 to {}",
      option.get_name(),
      text.empty() ? "empty" : text,
      most_of(option)
  );
}

void check_int(const CLI::Option& option, const std::string& text) {
  const double most = static_cast<double>(most_of(option));
  GLINT_CHECK(
      !text.empty() && std::abs(std::strtod(text.c_str(), nullptr)) <= most,
      kUsage,
      "{} is {}; expected a whole number of at most {}",
      option.get_name(),
      text.empty() ? "empty" : text,
      most_of(option)
  );
}

}  // namespace

CLI::Validator above_zero() {
  return number_check("POSITIVE", "above 0", [](double value) { return value > 0; });
}

CLI::Validator at_least_zero() {
  return number_check("NONNEGATIVE", "at least 0", [](double value) { return value >= 0; });
}

void check_numbers(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& text : option->results()) {
      if (option->get_type_name().starts_with("FLOAT")) check_float(*option, text);
      if (option->get_type_name().starts_with("UINT")) check_unsigned(*option, text);
      if (option->get_type_name().starts_with("INT")) check_int(*option, text);
    }
  for (const CLI::App* verb : app.get_subcommands()) check_numbers(*verb);
}

}  // namespace glint
