// SPDX-License-Identifier: MIT
// One way to fail: throw glint::Error. It carries the exit code that main() returns.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace glint {

// Exit codes of every program (docs/reference/verbs.md).
enum class ExitCode : int {
  kSuccess = 0,
  kUsage = 1,          // wrong command line
  kBadPrediction = 2,  // a prediction (render, mesh, run folder) cannot be used
  kBadReference = 3,   // a dataset or reference cannot be used
  kCheckFailed = 4,    // a check ran and found something wrong
  kPartial = 5,        // some cells failed, tables were written
  kEnvironment = 6,    // machine, driver, disk, permissions
};

class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

// Errors of the machine that are recorded under names of their own.
struct OutOfMemory : Error {
  explicit OutOfMemory(const std::string& message) : Error(ExitCode::kEnvironment, message) {}
};
struct DiskFull : Error {
  explicit DiskFull(const std::string& message) : Error(ExitCode::kEnvironment, message) {}
};
struct MissingWeights : Error {  // of a network: not there, or damaged
  explicit MissingWeights(const std::string& message) : Error(ExitCode::kEnvironment, message) {}
};

// The same failure with another exit code: loaders do not know whether a file is a prediction or a
// reference, their callers do.
template <class F>
auto with_exit_code(ExitCode code, F&& body) {
  try {
    return body();
  } catch (const Error& error) {
    if (error.code() == ExitCode::kEnvironment || error.code() == ExitCode::kUsage) throw;
    throw Error(code, error.what());
  }
}

}  // namespace glint

// Throws Error(code, fmt::format(...)) when `condition` is false. The message names the file, the
// field, what was found, what was expected and how to mend it.
#define GLINT_CHECK(condition, code, ...)                                                        \
  do {                                                                                           \
    if (!(condition)) throw ::glint::Error(::glint::ExitCode::code, ::fmt::format(__VA_ARGS__)); \
  } while (false)
