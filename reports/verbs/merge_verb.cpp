// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <memory>

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "reports/run/parcels/complete_meshes.h"
#include "reports/run/parcels/find_parcels.h"
#include "reports/run/parcels/take_parcel.h"
#include "reports/verbs/verb.h"

namespace glint {
namespace {

struct MergeOptions {
  std::vector<std::string> from;
  bool dry_run = false;
};

struct MergeResult {
  fs::path into;
  std::vector<MergedCell> cells;
  std::vector<LostParcel> lost;
  std::vector<CompletedCell> completed;
};

void merge_folder(
    const std::string& from, const std::string& profile, bool write, MergeResult& result
) {
  const fs::path folder = folder_with_records(from, profile);
  std::error_code code;
  GLINT_CHECK(
      !fs::equivalent(folder, result.into, code),
      kUsage,
      "merge: {} is the folder that it would be merged into; --out names another",
      folder.string()
  );
  const auto cells = merge_runs(result.into, folder, write);
  result.cells.insert(result.cells.end(), cells.begin(), cells.end());
}

void merge_parcels(const std::string& from, bool write, MergeResult& result) {
  auto lost = for_each_parcel(from, [&](const Parcel& parcel, const std::string& place) {
    result.cells.push_back(take_parcel(result.into, parcel, place, write));
    if (!write && result.cells.back().verdict == MergeVerdict::kTaken && wants_meshes(parcel))
      result.completed.push_back({parcel.record.cell, true, ""});
  });
  for (LostParcel& parcel : lost) {
    log::warn(fmt::format("{}: {}", parcel.file, parcel.why));
    result.lost.push_back(std::move(parcel));
  }
}

MergeResult merge_all(const CommonOptions& common, const MergeOptions& options) {
  const Profile profile = load_profile(common.profile);
  const bool write = !options.dry_run;
  MergeResult result{own_profile_folder(common.out, profile.name)};
  result.cells = adopt_runs(result.into, write);
  std::erase_if(result.cells, [](const MergedCell& cell) {
    return cell.verdict == MergeVerdict::kReplicate;  // its own
  });
  for (const std::string& from : options.from)
    if (holds_parcels(from))
      merge_parcels(from, write, result);
    else
      merge_folder(from, common.profile, write, result);
  for (CompletedCell& cell : complete_meshes({profile, result.into, common.scene_loader(), write}))
    result.completed.push_back(std::move(cell));
  return result;
}

std::string counts_text(const MergeResult& result) {
  std::map<std::string_view, int> counts;
  for (const MergedCell& cell : result.cells) ++counts[merge_verdict_name(cell.verdict)];
  std::string text;
  for (const auto& [verdict, count] : counts) text += fmt::format("{} {}, ", count, verdict);
  text += (result.cells.empty() ? "nothing to merge into " : "into ") + result.into.string() + "\n";
  if (!result.lost.empty())
    text += fmt::format("{} parcels or archives could not be used\n", result.lost.size());
  return text;
}

// The lists of the JSON, which are one in text.
struct MergedRows {
  Rows cells, lost, meshes;
};

MergedRows rows_of(const MergeResult& result, bool dry_run) {
  constexpr std::string_view kCell = "scene method seed";
  MergedRows rows{
      Rows({{""}, {"verdict"}, {"from"}, {"why"}}, kCell),
      Rows({{""}, {""}, {"file"}, {"why"}}),
      Rows({{""}, {"made"}, {""}, {"why_not"}}, kCell)};
  for (const auto& [cell, verdict, from, why] : result.cells) {
    const std::string_view word = merge_verdict_name(verdict);
    rows.cells.add({cell.text(), word, from, why, cell.scene, cell.method, cell.seed});
  }
  for (const auto& [file, why] : result.lost) rows.lost.add({"-", "lost", file, why});
  for (const auto& [cell, is_made, why] : result.completed) {
    const Cell made(is_made, !is_made ? "no meshes" : (dry_run ? "would be meshed" : "meshed"));
    rows.meshes.add({cell.text(), made, "", why, cell.scene, cell.method, cell.seed});
  }
  return rows;
}

std::string merged_text(const MergedRows& rows, const MergeResult& result) {
  std::vector<std::vector<std::string>> lines;
  for (const Rows* part : {&rows.cells, &rows.lost, &rows.meshes})
    for (const auto& line : part->lines()) lines.push_back(line);
  return aligned_rows(lines) + counts_text(result);
}

Json merged_json(const MergedRows& rows, const MergeResult& result) {
  return {
      {"folder", result.into.string()},
      {"cells", rows.cells.json()},
      {"lost", rows.lost.json()},
      {"meshes", rows.meshes.json()}};
}

int exit_code_of(const MergeResult& result) {
  const bool conflict =
      std::any_of(result.cells.begin(), result.cells.end(), [](const MergedCell& cell) {
        return cell.verdict == MergeVerdict::kConflict;
      });
  if (conflict) return static_cast<int>(ExitCode::kCheckFailed);
  return static_cast<int>(result.lost.empty() ? ExitCode::kSuccess : ExitCode::kPartial);
}

int run_merge(const CommonOptions& common, const MergeOptions& options) {
  install_interrupt_handler();
  const MergeResult result = merge_all(common, options);
  const MergedRows rows = rows_of(result, options.dry_run);
  print_result(common, merged_json(rows, result), merged_text(rows, result));
  return exit_code_of(result);
}

void add_merge_verb(CommandLine& line) {
  auto options = std::make_shared<MergeOptions>();
  CLI::App* verb = line.add_verb(
      line.app,
      "merge",
      "results of other machines into OUT/PROFILE; exits with 4 where scores differ",
      [&line, options] { return run_merge(line.common, *options); },
      kOutOption | kDataOption | kProfileOption | kDeviceOption | kThreadsOption | kJsonOption |
          kQuietOption
  );
  verb->add_option(
      "from",
      options->from,
      "folders of other machines; parcels (run --parcels), folders or tar archives of them; none: "
      "run folders copied into OUT/PROFILE"
  );
  verb->add_flag("--dry-run", options->dry_run, "say what would be done, and do nothing");
}

}  // namespace

GLINT_REGISTER(Verb, {"merge", add_merge_verb})

}  // namespace glint
