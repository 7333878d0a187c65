// SPDX-License-Identifier: MIT
// "Not there" is one answer of several to a look at a file, and glint/core/presence.h tells them
// apart: no source looks for itself but those named here.
#include <catch2/catch.hpp>

#include <algorithm>

#include "glint/core/presence.h"

using namespace glint;

namespace {

// The beginning of a path, and why files there look for themselves.
struct OwnLookup {
  std::string_view path, why;
};
constexpr OwnLookup kOwnLookups[] = {
    {"glint/core/presence.", "for all others"},
    {"glint/core/machine.cpp", "/proc, control groups, the nearest folder that is there"},
    {"glint/core/left_behind.cpp", "/proc"},
    {"reports/run/records/environment.cpp", "/etc/os-release"},
    {"glint/scene/safetensors.h", "keeps what open_file() gave"},
    {"reports/run/parcels/tar_file.cpp", "keeps what open_file() gave"}};

bool may_look(const std::string& path) {
  return std::any_of(std::begin(kOwnLookups), std::end(kOwnLookups), [&](const OwnLookup& own) {
    return path.starts_with(own.path);
  });
}

// The rest of each line from where it looks for itself; not where open_file() does it.
std::vector<std::string> lookups_of(std::string_view text) {
  constexpr std::string_view kWords[] = {
      "fs::exists(",
      "fs::is_regular_file(",
      "fs::is_directory(",
      "fs::directory_iterator",
      "fs::recursive_directory_iterator",
      "filesystem::exists(",
      "filesystem::directory_iterator",
      "filesystem::recursive_directory_iterator",
      "std::ifstream",
      "fopen("};
  std::vector<std::string> found;
  for (const std::string_view word : kWords)
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string_view::npos; ++at) {
      const std::string_view line = text.substr(at, text.find('\n', at) - at);
      if (line.find(" = open_file(") == std::string_view::npos) found.emplace_back(line);
    }
  return found;
}

bool is_source(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".h" || extension == ".cpp" || extension == ".cu" || extension == ".cuh";
}

}  // namespace

TEST_CASE("the check finds lookups, but not what presence.h gave") {
  CHECK(lookups_of("if (fs::exists(a)) {\n std::ifstream in(a);\n").size() == 2);
  CHECK(lookups_of("for (auto& e : fs::directory_iterator(a))").size() == 1);
  CHECK(lookups_of("std::ifstream in = open_file(a);\nis_there(a); fs::is_empty(a)").empty());
}

TEST_CASE("files are looked up and opened by presence.h") {
  std::size_t seen = 0;
  for (const char* folder : {"glint", "metrics", "baselines", "datasets", "reports", "python"})
    for (const fs::path& file : list_files_below(folder)) {
      if (!is_source(file) || may_look(file.generic_string())) continue;
      ++seen;
      INFO(file.string());
      CHECK(lookups_of(read_file(file)) == std::vector<std::string>());
    }
  CHECK(seen > 500);
}
