// SPDX-License-Identifier: MIT
#include "reports/run/code/source_tree.h"

#include <algorithm>
#include <set>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/sha256.h"

namespace glint {
namespace {

constexpr std::size_t kHashDigits = 12;

std::string extension_of(const std::string& file) { return fs::path(file).extension().string(); }
bool is_source(const std::string& file) {
  const std::string extension = extension_of(file);
  return extension == ".h" || extension == ".cuh" || extension == ".cpp" || extension == ".cu";
}
bool is_unit(const std::string& file) {
  return extension_of(file) == ".cpp" || extension_of(file) == ".cu";
}
fs::path folder_of(const std::string& file) { return fs::path(file).parent_path(); }

// "a/x" of a/x.cpp and a/x.cu.
std::string stem_of(const std::string& file) { return fs::path(file).replace_extension().string(); }

// Without comment lines, empty lines and the blanks around lines, so that writing about code does
// not call for new results.
std::string code_of(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  std::string code;
  for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
    end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    const std::size_t first = line.find_first_not_of(kBlanks);
    if (first == std::string_view::npos || line.substr(first).starts_with("//")) continue;
    code.append(line.substr(first, line.find_last_not_of(kBlanks) + 1 - first)) += '\n';
  }
  return code;
}

std::vector<std::string> quoted_includes(std::string_view code) {
  std::vector<std::string> includes;
  constexpr std::string_view kOpening = "#include \"";
  for (std::size_t at = 0; (at = code.find(kOpening, at)) != std::string_view::npos;) {
    const bool opens_line = at == 0 || code[at - 1] == '\n';
    at += kOpening.size();
    if (opens_line) includes.emplace_back(code.substr(at, code.find('"', at) - at));
  }
  return includes;
}

bool has_registration(std::string_view code) {
  for (const char* word : {"GLINT_REGISTER", " = register_methods<"})  // glint/surfel_method.h
    if (code.find(word) != std::string_view::npos) return true;
  return false;
}

}  // namespace

SourceTree::SourceTree(const fs::path& root) {
  for (const char* folder : {"glint", "metrics", "datasets", "baselines", "reports"}) {
    const auto is_other = [](const fs::path& path) {
      return !is_folder(path) && !is_source(path.string());
    };
    for (const fs::path& file : list_files_below(root / folder, is_other)) read(root, file);
  }
  find_implementations();
}

void SourceTree::read(const fs::path& root, const fs::path& file) {
  Source source;
  source.code = code_of(read_file(file));
  source.includes = quoted_includes(source.code);
  const std::string name = file.lexically_relative(root).generic_string();
  source.registers =
      is_unit(name) && !name.starts_with("reports/") && has_registration(source.code);
  sources_[name] = std::move(source);
}

void SourceTree::find_implementations() {
  for (const auto& [name, source] : sources_) {
    if (!is_unit(name) || source.registers) continue;
    const std::string own = stem_of(name) + ".h";
    const auto implements = [&, &file = name](const std::string& header) {
      const auto found = sources_.find(header);
      if (found != sources_.end()) found->second.implementations.push_back(file);
    };
    if (sources_.contains(own)) {
      implements(own);
      continue;
    }
    for (const std::string& header : source.includes)
      if (folder_of(header) == folder_of(name)) implements(header);
  }
}

std::vector<std::string> SourceTree::matching(const std::string& pattern) const {
  std::vector<std::string> found;
  for (const auto& [name, source] : sources_)
    if (glob_match(pattern, name)) found.push_back(name);
  GLINT_CHECK(
      !found.empty(),
      kBadReference,
      "{}: no such source; reports/run/code/stage_sources.cpp names it",
      pattern
  );
  return found;
}

std::vector<std::string> SourceTree::registering() const {
  std::vector<std::string> found;
  for (const auto& [name, source] : sources_)
    if (source.registers) found.push_back(name);
  return found;
}

std::vector<std::string> SourceTree::closure(const std::vector<std::string>& files) const {
  std::set<std::string> reached(files.begin(), files.end());
  std::vector<std::string> open(reached.begin(), reached.end());
  const auto reach = [&](const std::vector<std::string>& names) {
    for (const std::string& name : names)
      if (sources_.contains(name) && !name.starts_with("reports/") && reached.insert(name).second)
        open.push_back(name);
  };
  while (!open.empty()) {
    const std::string name = open.back();
    open.pop_back();
    if (name.starts_with("reports/")) continue;
    const Source& source = sources_.at(name);
    reach(source.includes);
    reach(source.implementations);
  }
  return {reached.begin(), reached.end()};
}

std::string SourceTree::hash_of(const std::string& file) const {
  return sha256(sources_.at(file).code).substr(0, kHashDigits);
}

}  // namespace glint
