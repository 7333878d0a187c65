// SPDX-License-Identifier: MIT
// What this program was built with; written by CMake (cmake/glint_build_info.cmake).
#pragma once

#include <map>
#include <string>

namespace glint {

struct BuildInfo {
  std::string type;                              // "Release"
  std::string flags;                             // of C++, the same for all files but -O
  std::string cuda;                              // "nvcc 13.0.88 for 80"; empty: without
  std::map<std::string, std::string> libraries;  // name -> version, as they were found then
};
const BuildInfo& build_info();

}  // namespace glint
