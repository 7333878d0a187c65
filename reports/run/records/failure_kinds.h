// SPDX-License-Identifier: MIT
// What kinds of failure there are, and what is done about each.
#pragma once

#include <string_view>
#include <vector>

#include "reports/run/records/records.h"

namespace glint {

namespace failure {
inline constexpr std::string_view kBadInput = "bad-input", kUsage = "usage",
                                  kEnvironment = "environment", kNotFinite = "not-finite",
                                  kOutOfMemory = "out-of-memory", kTimeout = "timeout",
                                  kCrash = "crash", kPreempted = "preempted",
                                  kDiskFull = "disk-full", kMissingWeights = "missing-weights",
                                  kUnknown = "unknown";
}  // namespace failure

struct FailureKind {
  std::string_view id, meaning;
  int retries;            // within one `all`; every later `all` tries once more
  std::string_view cure;  // for people
};

const std::vector<FailureKind>& failure_kinds();

// Of a kind that a newer program wrote: as kUnknown's.
const FailureKind& failure_kind_of(std::string_view id);

// In which kind `error`, thrown in `stage`, falls.
std::string_view failure_kind(const std::exception& error, std::string_view stage);

// The iteration that the training in a run folder had reached, by its log and checkpoints; -1: none
// is known.
int last_iteration(const fs::path& run);

}  // namespace glint
