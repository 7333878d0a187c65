// SPDX-License-Identifier: MIT
#pragma once

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace glint {

// Checks of an option, in place of CLI11's own, whose messages print the largest double.
CLI::Validator above_zero();
CLI::Validator at_least_zero();

// Numbers of a parsed command line and its verbs. Errors (kUsage): one is not finite; CLI11 takes
// "nan" and "inf", and comparisons with them let anything pass. A whole number without sign is
// negative or larger than 64 bits, which CLI11 wraps around and clamps.
void check_numbers(const CLI::App& app);

}  // namespace glint
