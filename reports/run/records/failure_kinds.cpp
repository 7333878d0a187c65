// SPDX-License-Identifier: MIT
#include "reports/run/records/failure_kinds.h"

#include <algorithm>

#include "glint/core/presence.h"
#include "glint/core/process.h"
#include "glint/train/checkpoint.h"
#include "reports/run/records/run_folder.h"

namespace glint {

const std::vector<FailureKind>& failure_kinds() {
  using namespace failure;
  static const std::vector<FailureKind> kinds = {
      {kBadInput, "data or a file of the run cannot be used", 0, "mend what the message names"},
      {kUsage, "a setting is wrong", 0, "mend what the message names"},
      {kEnvironment, "the machine lacks something: device, permission, a library", 1, "`doctor`"},
      {kNotFinite, "the training diverged", 0, "see the end of its log; --set a smaller rate"},
      {kOutOfMemory,
       "memory ran out, or would have",
       1,
       "fewer --jobs, a smaller max_pixels or max_surfels"},
      {kTimeout, "ran longer than --time-limit", 0, "goes on from its checkpoint; a longer limit"},
      {kCrash, "the process ended without a word of its own", 1, "see the end of its output"},
      {kPreempted, "was told to stop from outside", 3, "goes on from its checkpoint"},
      {kDiskFull, "the disk is full", 0, "free some space, `status --leftovers`, or another --out"},
      {kMissingWeights, "weights of a network are missing", 0, "`doctor` says where they go"},
      {kUnknown, "none of the others", 0, "see the message"}};
  return kinds;
}

const FailureKind& failure_kind_of(std::string_view id) {
  const auto& kinds = failure_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const FailureKind& kind) {
    return kind.id == id;
  });
  return found == kinds.end() ? kinds.back() : *found;
}

std::string_view failure_kind(const std::exception& error, std::string_view stage) {
  if (out_of_memory_message(error) || dynamic_cast<const OutOfMemory*>(&error))
    return failure::kOutOfMemory;
  if (dynamic_cast<const DiskFull*>(&error)) return failure::kDiskFull;
  if (dynamic_cast<const MissingWeights*>(&error)) return failure::kMissingWeights;
  const auto* ours = dynamic_cast<const Error*>(&error);
  if (!ours) return failure::kUnknown;
  switch (ours->code()) {
    case ExitCode::kBadPrediction:
      return stage == "train" ? failure::kNotFinite : failure::kBadInput;
    case ExitCode::kBadReference:
      return failure::kBadInput;
    case ExitCode::kUsage:
      return failure::kUsage;
    case ExitCode::kEnvironment:
      return failure::kEnvironment;
    default:
      return failure::kUnknown;
  }
}

namespace {

int iteration_of_log(const fs::path& run) {
  for (const std::string& line : log_tail(run, 1))
    if (const Json json = parse_json(line); json.is_object() && json.contains("iteration"))
      if (const Json& iteration = json["iteration"]; iteration.is_number_integer())
        return iteration.get<int>();
  return -1;
}

int iteration_of_checkpoint(const fs::path& run) {
  if (!is_there(run / kProgressFile)) return -1;
  const Json json = parse_json(read_file(run / kProgressFile));
  return json.is_object() ? json.value("iterations", -1) : -1;
}

}  // namespace

int last_iteration(const fs::path& run) {
  return std::max(iteration_of_log(run), iteration_of_checkpoint(run));
}

}  // namespace glint
