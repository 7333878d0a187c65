// SPDX-License-Identifier: MIT
// glint-code-hashes ROOT OUTPUT: writes the C++ file behind reports/run/records/code_hashes.h.
// Run at every build; the file is touched only when a hash has changed.
#include <fmt/format.h>
#include <cstdio>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "reports/run/code/source_tree.h"
#include "reports/run/code/stage_sources.h"

namespace glint {
namespace {

std::string entry(const SourceTree& tree, const std::string& name, std::vector<std::string> files) {
  std::string text = fmt::format("      {{\"{}\",\n       {{", name);
  for (const std::string& file : tree.closure(files))
    text += fmt::format("{{\"{}\", \"{}\"}},\n        ", file, tree.hash_of(file));
  return text + "}},\n";
}

std::string generated(const SourceTree& tree) {
  std::string text =
      "// Written by glint-code-hashes at build time.\n"
      "#include \"reports/run/records/code_hashes.h\"\n\n"
      "namespace glint {\n\n"
      "const std::map<std::string, CodeHashes>& code_hashes() {\n"
      "  static const std::map<std::string, CodeHashes> all = {\n";
  for (const StageSources& stage : stage_sources()) {
    std::vector<std::string> files;
    for (const std::string& pattern : stage.patterns)
      for (const std::string& file : tree.matching(pattern)) files.push_back(file);
    text += entry(tree, stage.name, files);
  }
  for (const std::string& file : tree.registering()) text += entry(tree, file, {file});
  return text + "  };\n  return all;\n}\n\n}  // namespace glint\n";
}

int write_code_hashes(int argc, const char* const* argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: glint-code-hashes ROOT OUTPUT\n");
    return 1;
  }
  const fs::path output = argv[2];
  const std::string text = generated(SourceTree(argv[1]));
  if (!is_there(output) || read_file(output) != text) write_file(output, text);
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) {
  try {
    return glint::write_code_hashes(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "glint-code-hashes: {}\n", error.what());
    return 1;
  }
}
