// SPDX-License-Identifier: MIT
#include "reports/run/records/profile_folder.h"

#include <algorithm>

#include "glint/core/presence.h"
#include "reports/run/records/embedded.h"
#include "reports/run/records/records.h"

namespace glint {

namespace {

constexpr const char* kRecordsFile = "records.jsonl";
constexpr const char* kSingleRuns = "single";  // in records of runs apart from profiles

bool has_records(const fs::path& folder) {
  const fs::path file = folder / kRecordsFile;
  return with_exit_code(ExitCode::kBadPrediction, [&] {
    return is_file(file) && fs::file_size(file) > 0;
  });
}

// "; out has records of smoke (--profile smoke)"; empty: of none.
std::string other_profiles(const fs::path& out) {
  std::vector<std::string> names;
  for (const fs::path& folder : or_warn([&] { return list_folders(out); }))
    if (or_warn([&] { return has_records(folder); })) names.push_back(folder.filename().string());
  if (names.empty()) return "";
  return fmt::format(
      "; {0} has records of {1}: name the folder, e.g. --out {2}",
      out.string(),
      fmt::join(names, ", "),
      (out / names.front()).string()
  );
}

std::string whose_records(const std::string& profile) {
  return profile == kSingleRuns ? "single runs" : "profile " + profile;
}

// How another command would use records that are there; empty: no --profile names them.
std::string how_to_name(const std::string& profile) {
  if (profile == kSingleRuns) return "";
  const std::vector<std::string> known = embedded_names("profiles");
  const bool embedded = std::find(known.begin(), known.end(), profile) != known.end();
  return (embedded ? "--profile " + profile : "--profile with its file") + ", or ";
}

}  // namespace

fs::path profile_folder(const fs::path& out, const std::string& profile) {
  const fs::path below = out / profile;
  return !has_records(below) && has_records(out) ? out : below;
}

fs::path own_profile_folder(const fs::path& out, const std::string& profile) {
  const fs::path folder = profile_folder(out, profile);
  if (folder != out) return folder;
  const auto records = read_records(folder / kRecordsFile);
  const bool own = std::any_of(records.begin(), records.end(), [&](const Record& record) {
    return record.profile == profile || record.profile.empty();
  });
  GLINT_CHECK(
      own || records.empty(),
      kUsage,
      "--out {}: holds the records of {}; give {}another --out for {}",
      out.string(),
      whose_records(records.front().profile),
      how_to_name(records.front().profile),
      whose_records(profile)
  );
  return folder;
}

fs::path folder_with_records(const fs::path& out, const std::string& given_profile) {
  const std::string profile = fs::path(given_profile).stem().string();
  const fs::path folder = profile_folder(out, profile);
  if (!has_records(folder)) {
    // A folder that is named like its profile was meant itself.
    const bool itself = out.filename() == profile;
    const fs::path parent = out.has_parent_path() ? out.parent_path() : fs::path(".");
    throw Error(
        ExitCode::kBadPrediction,
        fmt::format(
            "{}: no records.jsonl; run `glint-bench all --profile {} --out {}` first{}",
            (itself ? out : folder).string(),
            given_profile,
            (itself ? parent : out).string(),
            other_profiles(out)
        )
    );
  }
  return folder;
}

}  // namespace glint
