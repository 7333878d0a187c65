// SPDX-License-Identifier: MIT
// A folder of a test's own, removed at its end; and failing code with a stated exit code.
#pragma once

#include <catch2/catch.hpp>
#include <string>

#include "glint/core/error.h"
#include "glint/core/files.h"

namespace glint::test {

struct TempFolder : TemporaryFolder {
  TempFolder() : TemporaryFolder("glint_test") {}
};

// Runs `body`, which must throw an Error with that exit code, and returns its message.
template <class F>
std::string error_of(ExitCode code, F&& body) {
  try {
    body();
  } catch (const Error& error) {
    INFO(error.what());
    CHECK(error.code() == code);
    return error.what();
  }
  FAIL("no error was thrown");
  return {};
}

template <class F>
std::string bad_reference(F&& body) {
  return error_of(ExitCode::kBadReference, body);
}

}  // namespace glint::test
