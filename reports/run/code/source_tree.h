// SPDX-License-Identifier: MIT
// Which sources a result depends on: what a file includes, and what implements the headers among
// it. A header x.h is implemented by x.cpp beside it, and by those files beside it that have no
// header of their own name and include it. Files that register something (a method, a loader) are
// nobody's implementation: only who asks for one gets it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

class SourceTree {
 public:
  // Reads the sources below `root` in glint/, metrics/, datasets/, baselines/ and reports/. Errors:
  // as read_file.
  explicit SourceTree(const fs::path& root);

  // Files that match a glob ("metrics/view/*.cpp"). Errors (kBadReference): none does.
  std::vector<std::string> matching(const std::string& pattern) const;
  // Those that call GLINT_REGISTER...().
  std::vector<std::string> registering() const;
  // The files and all they depend on, by name. Of reports/, which drives the computation, only
  // files that are named count, not what they include.
  std::vector<std::string> closure(const std::vector<std::string>& files) const;
  // Hexadecimal, of the file without comment lines and blanks around lines.
  std::string hash_of(const std::string& file) const;

 private:
  struct Source {
    std::string code;
    std::vector<std::string> includes, implementations;
    bool registers = false;
  };
  void read(const fs::path& root, const fs::path& file);
  void find_implementations();

  std::map<std::string, Source> sources_;
};

}  // namespace glint
