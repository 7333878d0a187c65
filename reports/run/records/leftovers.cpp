// SPDX-License-Identifier: MIT
#include "reports/run/records/leftovers.h"

#include <algorithm>
#include <optional>

#include "glint/core/error.h"
#include "glint/core/file_lock.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/train/checkpoint.h"
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/records.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

std::uintmax_t bytes_of(const std::vector<fs::path>& files) {
  std::error_code code;
  std::uintmax_t sum = 0;
  for (const fs::path& file : files)
    if (const std::uintmax_t bytes = fs::file_size(file, code); !code) sum += bytes;
  return sum;
}

std::uintmax_t bytes_below(const fs::path& path) {
  if (!is_real_folder(path)) return bytes_of({path});
  return bytes_of(or_warn([&] { return list_files_below(path); }));
}

// Why a run belongs to no finished cell; nothing: it does, or it is kept.
std::optional<std::string> why_leftover(
    const fs::path& run, const Record* record, bool unfinished
) {
  if (record != nullptr && record->ok()) return std::nullopt;
  if (record != nullptr)
    return unfinished ? std::optional("failed: " + record->failure->message) : std::nullopt;
  const bool goes_on =
      is_there(run / kCheckpointFile) || read_stage(run, Stage::kTrain).has_value();
  if (!goes_on) return "stopped before it left anything to go on from";
  return unfinished ? std::optional<std::string>("not finished") : std::nullopt;
}

const Record* record_of(
    const fs::path& run, const fs::path& folder, const std::vector<Record>& records
) {
  const std::string cell = run.lexically_relative(folder / "runs").generic_string();
  const auto found = std::find_if(records.begin(), records.end(), [&](const Record& record) {
    return record.cell.text() == cell;
  });
  return found == records.end() ? nullptr : &*found;
}

bool is_at_work(const fs::path& run) {
  return std::holds_alternative<std::string>(FileLock::take(FileLock::file_beside(run)));
}

void add_run(
    const fs::path& run, const Record* record, bool unfinished, std::vector<Leftover>& found
) {
  if (is_at_work(run)) return;
  if (const auto why = why_leftover(run, record, unfinished)) {
    found.push_back({run, *why, bytes_of(files_of_run(run)), true});
    return;
  }
  const bool trained = read_stage(run, Stage::kTrain).has_value();
  if (trained && is_there(run / kCheckpointFile))
    found.push_back(
        {run / kCheckpointFile, "the training has ended", bytes_of({run / kCheckpointFile}), false}
    );
  const fs::path previous = run / kPreviousRun;
  if (trained && is_our_run(previous))
    found.push_back({previous, "a later run took its place", bytes_of(files_of_run(previous)), true}
    );
}

}  // namespace

std::vector<Leftover> find_leftovers(const fs::path& folder, bool unfinished) {
  std::vector<Leftover> found;
  for (const fs::path& path : list_left_behind(folder))
    found.push_back({path, "the process that wrote it has ended", bytes_below(path), false});
  const std::vector<Record> records = read_records(folder / "records.jsonl");
  for (const fs::path& run : runs_below(folder / "runs"))
    or_warn([&] { add_run(run, record_of(run, folder, records), unfinished, found); });
  return found;
}

void remove_leftover(const Leftover& leftover) {
  if (leftover.is_run) return remove_run(leftover.path);
  std::error_code code;
  fs::remove_all(leftover.path, code);
  GLINT_CHECK(
      !code,
      kEnvironment,
      "{}: cannot be removed ({}); give write permission to its folder",
      leftover.path.string(),
      code.message()
  );
}

}  // namespace glint
