// SPDX-License-Identifier: MIT
// A folder of a test's own, removed at its end; and failing code with a stated exit code.
#pragma once

#include <unistd.h>

#include <catch2/catch.hpp>
#include <string>

#include "glint/core/error.h"
#include "glint/core/files.h"

namespace glint::test {

class TempFolder {
 public:
  TempFolder() {
    std::string pattern = (fs::temp_directory_path() / "glint_test_XXXXXX").string();
    GLINT_CHECK(::mkdtemp(pattern.data()) != nullptr, kEnvironment, "cannot make {}", pattern);
    path_ = pattern;
  }
  ~TempFolder() {
    std::error_code code;
    fs::remove_all(path_, code);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const fs::path& path() const { return path_; }
  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
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
