// SPDX-License-Identifier: MIT
#include "reports/run/records/merge_runs.h"

#include <algorithm>
#include <array>
#include <set>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "reports/run/records/copy_run.h"
#include "reports/run/records/record_facts.h"
#include "reports/run/records/run_folder.h"

namespace glint {
namespace {

// "node7 (AMD EPYC)".
std::string machine_of(const Record& record) {
  const std::string name = environment_text(record, "machine");
  const std::string cpu = environment_text(record, "cpu");
  if (name.empty() && cpu.empty()) return "an unknown machine";
  return name.empty() || cpu.empty() ? name + cpu : fmt::format("{} ({})", name, cpu);
}

// Why two trainings have other keys, as far as records tell.
std::string training_differences(const Record& a, const Record& b) {
  if (a.dataset_hash != b.dataset_hash) return "trained on other data";
  const std::string of_a = environment_text(a, "git_revision"),
                    of_b = environment_text(b, "git_revision");
  if (of_a != of_b && !of_a.empty() && !of_b.empty())
    return fmt::format("trained by other settings or code (revisions {} and {})", of_a, of_b);
  return "trained by other settings or code";
}

// The keys of its scores: also of those that came without meshes, before these were made.
std::set<std::string> score_keys(const Record& record) {
  std::set<std::string> keys{record.score_key};
  if (record.meshes_made.is_object() && record.meshes_made.value("score_key", Json()).is_string())
    keys.insert(record.meshes_made["score_key"].get<std::string>());
  return keys;
}

bool is_scored_alike(const Record& a, const Record& b) {
  const auto of_a = score_keys(a), of_b = score_keys(b);
  return std::any_of(of_a.begin(), of_a.end(), [&](const std::string& key) {
    return of_b.contains(key);
  });
}

bool is_of_meshes(const std::string& id) {
  return id.starts_with("mesh-") || id.starts_with("behind-mesh-");
}

std::vector<fs::path> record_files_below(const fs::path& runs) {
  return with_exit_code(ExitCode::kBadPrediction, [&] {
    return list_files_below(runs, [](const fs::path& path) {
      const std::string name = path.filename().string();
      if (!is_real_folder(path)) return name != kRecordFile;
      return name.starts_with(".") || name == "renders" || name == "keys";
    });
  });
}

// run folder -> the record that it holds, of those below `runs`.
std::vector<Record> records_beside_runs(const fs::path& runs) {
  std::vector<Record> records;
  for (const fs::path& file : record_files_below(runs)) {
    const Json json = parse_json(read_file(file));
    try {
      Record record = record_from_json(json, file.string());
      std::error_code code;
      const bool in_place =
          fs::equivalent(file.parent_path(), run_folder(runs.parent_path(), record.cell), code);
      if (in_place && !code) records.push_back(std::move(record));
    } catch (const Error& error) {
      log::warn(error.what());
    }
  }
  std::sort(records.begin(), records.end(), [](const Record& a, const Record& b) {
    return a.cell < b.cell;
  });
  return records;
}

}  // namespace

std::string_view merge_verdict_name(MergeVerdict verdict) {
  constexpr std::array<std::string_view, 4> kNames = {"taken", "replicate", "conflict", "left"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::string score_differences(const Record& a, const Record& b) {
  if (a.train_key != b.train_key) return training_differences(a, b);
  if (!is_scored_alike(a, b)) return "scored by other settings or code";
  const bool without_meshes = a.meshes_made.is_null() != b.meshes_made.is_null();
  std::set<std::string> ids;
  for (const Record* record : {&a, &b})
    for (const auto& [id, value] : record->metrics)
      if (!is_cost(id) && !(without_meshes && is_of_meshes(id))) ids.insert(id);
  std::string text;
  for (const std::string& id : ids) {
    const auto in_a = a.metrics.find(id), in_b = b.metrics.find(id);
    const bool both = in_a != a.metrics.end() && in_b != b.metrics.end();
    if (both && in_a->second == in_b->second) continue;
    text += text.empty() ? "" : ", ";
    text += both ? fmt::format("{} {} and {}", id, in_a->second, in_b->second)
                 : fmt::format("{} in one alone", id);
    if (text.size() > 200) return text + ", ...";
  }
  return text;
}

MergedCell judge_merge(const Record& theirs, const Record* ours, const std::string& from) {
  const auto is = [&](MergeVerdict verdict, const std::string& why = "") {
    return MergedCell{theirs.cell, verdict, from, why};
  };
  if (ours == nullptr || (!ours->ok() && theirs.ok())) return is(MergeVerdict::kTaken);
  if (!theirs.ok())
    return is(MergeVerdict::kLeft, fmt::format("failed there ({})", theirs.failure->kind));
  const std::string differences = score_differences(*ours, theirs);
  if (differences.empty()) return is(MergeVerdict::kReplicate);
  return is(
      MergeVerdict::kConflict,
      fmt::format(
          "{}; kept: that of {}, not of {}", differences, machine_of(*ours), machine_of(theirs)
      )
  );
}

std::vector<MergedCell> merge_runs(const fs::path& into, const fs::path& from, bool write) {
  std::vector<MergedCell> merged;
  const fs::path records_file = into / "records.jsonl";
  const auto ours = read_records(records_file);
  for (const Record& theirs : read_records(from / "records.jsonl")) {
    merged.push_back(judge_merge(theirs, find_record(ours, theirs.cell), from.string()));
    if (merged.back().verdict != MergeVerdict::kTaken) continue;
    copy_run(run_folder(from, theirs.cell), run_folder(into, theirs.cell), write);
    if (write) append_record(records_file, theirs);
  }
  return merged;
}

std::vector<MergedCell> adopt_runs(const fs::path& folder, bool write) {
  std::vector<MergedCell> merged;
  const fs::path records_file = folder / "records.jsonl";
  const auto ours = read_records(records_file);
  for (const Record& found : records_beside_runs(folder / "runs")) {
    const Record* known = find_record(ours, found.cell);
    merged.push_back(judge_merge(found, known, run_folder(folder, found.cell).string()));
    if (merged.back().verdict == MergeVerdict::kTaken && write) append_record(records_file, found);
  }
  return merged;
}

}  // namespace glint
