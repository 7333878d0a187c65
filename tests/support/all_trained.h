// SPDX-License-Identifier: MIT
// Every method, and what comes of a training.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/method.h"
#include "tests/support/temp_folder.h"

namespace glint::test {

inline std::vector<std::string> all_trained() {
  std::vector<std::string> all;
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) all.push_back(id);
  return all;
}

// What a method saves.
inline std::string saved_bytes(const Method& method) {
  const TempFolder folder;
  method.save(folder.path().string());
  std::string bytes;
  for (const fs::path& file : list_files(folder.path())) bytes += read_file(file);
  return bytes;
}

}  // namespace glint::test
