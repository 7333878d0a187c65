// SPDX-License-Identifier: MIT
// glint-bench inside of a test: its exit code, and what it prints.
#pragma once

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "reports/verbs/command_line.h"
#include "tests/support/temp_folder.h"

namespace glint::test {

inline int run(const std::vector<std::string>& words) {
  std::vector<const char*> arguments{"glint-bench"};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  return run_command_line(static_cast<int>(arguments.size()), arguments.data());
}

// What goes to a stream (1: output, 2: errors) while `body` runs.
template <class F>
std::string captured(int stream, F&& body) {
  const TempFolder folder;
  const std::string file = (folder / "captured").string();
  std::FILE* const own = stream == 1 ? stdout : stderr;
  std::fflush(own);
  const int kept = ::dup(stream);
  std::FILE* target = std::fopen(file.c_str(), "w");
  ::dup2(::fileno(target), stream);
  body();
  std::fflush(own);
  ::dup2(kept, stream);
  ::close(kept);
  std::fclose(target);
  return read_file(file);
}

}  // namespace glint::test
