// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <memory>

#include "glint/core/progress.h"
#include "reports/records/merge_runs.h"
#include "reports/verbs/listing.h"
#include "reports/verbs/verb.h"

namespace glint {
namespace {

struct MergeOptions {
  std::vector<std::string> from;
  bool dry_run = false;
};

std::vector<MergedCell> merge_all(
    const fs::path& into, const std::string& profile, const MergeOptions& options
) {
  std::vector<MergedCell> merged = adopt_runs(into, !options.dry_run);
  std::erase_if(merged, [](const MergedCell& cell) {
    return cell.verdict == MergeVerdict::kReplicate;  // its own
  });
  for (const std::string& from : options.from) {
    const fs::path folder = folder_with_records(from, profile);
    std::error_code code;
    GLINT_CHECK(
        !fs::equivalent(folder, into, code),
        kUsage,
        "merge: {} is the folder that it would be merged into; --out names another",
        folder.string()
    );
    const auto cells = merge_runs(into, folder, !options.dry_run);
    merged.insert(merged.end(), cells.begin(), cells.end());
  }
  return merged;
}

std::string merged_text(const std::vector<MergedCell>& merged, const fs::path& into) {
  std::vector<std::vector<std::string>> rows;
  std::map<std::string_view, int> counts;
  for (const MergedCell& cell : merged) {
    ++counts[merge_verdict_name(cell.verdict)];
    rows.push_back(
        {cell.cell.text(), std::string(merge_verdict_name(cell.verdict)), cell.from, cell.why}
    );
  }
  std::string text = listing(rows);
  for (const auto& [verdict, count] : counts) text += fmt::format("{} {}, ", count, verdict);
  return text + (merged.empty() ? "nothing to merge into " : "into ") + into.string() + "\n";
}

Json merged_json(const std::vector<MergedCell>& merged, const fs::path& into) {
  Json json = {{"folder", into.string()}, {"cells", Json::array()}};
  for (const MergedCell& cell : merged)
    json["cells"].push_back(
        {{"scene", cell.cell.scene},
         {"method", cell.cell.method},
         {"seed", cell.cell.seed},
         {"verdict", merge_verdict_name(cell.verdict)},
         {"from", cell.from},
         {"why", cell.why}}
    );
  return json;
}

int run_merge(const CommonOptions& common, const MergeOptions& options) {
  const fs::path into = own_profile_folder(common.out, load_profile(common.profile).name);
  const auto merged = merge_all(into, common.profile, options);
  if (common.json)
    print_json(merged_json(merged, into));
  else
    print_text(merged_text(merged, into));
  const bool conflict = std::any_of(merged.begin(), merged.end(), [](const MergedCell& cell) {
    return cell.verdict == MergeVerdict::kConflict;
  });
  return static_cast<int>(conflict ? ExitCode::kCheckFailed : ExitCode::kSuccess);
}

void add_merge_verb(CommandLine& line) {
  auto options = std::make_shared<MergeOptions>();
  CLI::App* verb = line.add_verb(
      line.app,
      "merge",
      "results of other machines into OUT/PROFILE; exits with 4 where scores differ",
      [&line, options] { return run_merge(line.common, *options); },
      kOutOption | kProfileOption | kJsonOption | kQuietOption
  );
  verb->add_option(
      "from", options->from, "folders of other machines; none: run folders copied into OUT/PROFILE"
  );
  verb->add_flag("--dry-run", options->dry_run, "say what would be done, and do nothing");
}

}  // namespace

GLINT_REGISTER(Verb, {"merge", add_merge_verb})

}  // namespace glint
