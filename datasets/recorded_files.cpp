// SPDX-License-Identifier: MIT
#include "datasets/recorded_files.h"

#include <algorithm>
#include <set>

#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/core/presence.h"
#include "glint/core/rng.h"

namespace glint {
namespace {

enum class FileState { kSame, kMissing, kChanged };

FileState state_of(const fs::path& file, const Json& hash) try {
  if (!is_file(file)) return FileState::kMissing;
  const bool same = hash == fmt::format("{:016x}", hash_name(read_file(file)));
  return same ? FileState::kSame : FileState::kChanged;
} catch (const OutOfMemory&) {
  throw;
} catch (const Error&) {
  return FileState::kMissing;  // it cannot be read
}

Json recorded_hashes(const fs::path& folder) {
  const fs::path description = folder / "scene.json";
  if (!is_file(description)) return Json::object();
  const Json json = parse_json(read_file(description));
  const Json files = json.is_object() ? json.value("files", Json()) : Json();
  return files.is_object() ? files : Json::object();
}

void report(
    const fs::path& folder,
    std::vector<std::string> names,
    std::size_t num_recorded,
    const std::string& state,
    std::vector<Finding>& findings
) {
  std::set<std::string> named;
  for (const Finding& finding : findings) named.insert(finding.where);
  std::erase_if(names, [&](const auto& name) { return named.contains((folder / name).string()); });
  if (names.empty()) return;
  findings.push_back(
      {"recorded-files",
       (folder / names.front()).string(),
       fmt::format(
           "{}; of the {} files that scene.json recorded when the scene was made, {} {} so; copy "
           "or "
           "make the scene again",
           state,
           num_recorded,
           names.size(),
           names.size() == 1 ? "is" : "are"
       )}
  );
}

}  // namespace

RecordedFiles compare_recorded(const fs::path& folder) {
  const Json hashes = recorded_hashes(folder);
  std::vector<std::pair<std::string, Json>> files;
  for (const auto& [name, hash] : hashes.items()) files.emplace_back(name, hash);
  std::vector<FileState> states(files.size());
  parallel_for(files.size(), 1, [&](std::size_t i) {
    states[i] = state_of(folder / files[i].first, files[i].second);
  });
  RecordedFiles result{.num_recorded = files.size(), .missing = {}, .changed = {}};
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (states[i] == FileState::kMissing) result.missing.push_back(files[i].first);
    if (states[i] == FileState::kChanged) result.changed.push_back(files[i].first);
  }
  return result;
}

void check_recorded(const fs::path& folder, std::vector<Finding>& findings) {
  const RecordedFiles files = compare_recorded(folder);
  report(folder, files.missing, files.num_recorded, "is missing or cannot be read", findings);
  report(
      folder,
      files.changed,
      files.num_recorded,
      "has other bytes than it was written with",
      findings
  );
}

}  // namespace glint
