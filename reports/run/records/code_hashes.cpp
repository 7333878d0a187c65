// SPDX-License-Identifier: MIT
#include "reports/run/records/code_hashes.h"

namespace glint {

Json code_json(const std::vector<std::string>& entries) {
  CodeHashes all;
  for (const std::string& entry : entries) {
    const auto found = code_hashes().find(entry);
    GLINT_CHECK(found != code_hashes().end(), kEnvironment, "{}: no hash of this code", entry);
    all.insert(found->second.begin(), found->second.end());
  }
  return all;
}

std::string code_entry_of(const std::string& source) {
  if (source.empty()) return {};
  for (const auto& [entry, files] : code_hashes())
    if (entry.find('/') != std::string::npos && (source == entry || source.ends_with("/" + entry)))
      return entry;
  throw Error(
      ExitCode::kEnvironment,
      fmt::format("{}: registers something, but the build has no hash of its code", source)
  );
}

}  // namespace glint
