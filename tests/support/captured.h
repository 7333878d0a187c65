// SPDX-License-Identifier: MIT
// What a test's code prints.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <string>

#include "tests/support/temp_folder.h"

namespace glint::test {

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
