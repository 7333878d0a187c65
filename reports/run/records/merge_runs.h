// SPDX-License-Identifier: MIT
// Results of several machines in one folder: cells that only one of them has are taken over with
// their run folders; of those that both have, equal ones are replicates and others conflicts.
#pragma once

#include <string>
#include <vector>

#include "reports/run/records/records.h"

namespace glint {

// In a run folder, beside its files: the record of the cell, so that run folders that were copied
// together can be adopted.
inline constexpr const char* kRecordFile = "record.json";

enum class MergeVerdict {
  kTaken,      // was not there, or had failed there
  kReplicate,  // there already, with the same scores
  kConflict,   // there already, with others
  kLeft        // failed where it comes from, and there is more already
};

struct MergedCell {
  CellKey cell;
  MergeVerdict verdict;
  std::string from;  // folder
  std::string why;   // of conflicts: what differs, and on which machines
};

std::string_view merge_verdict_name(MergeVerdict verdict);

// What would become of a record of another machine, `from` where it lies; `ours`: the one that is
// there, or null.
MergedCell judge_merge(const Record& theirs, const Record* ours, const std::string& from);

// Takes over from the profile's folder `from` into `into` what is not there; nothing that is there
// is changed. `write`: false: only says what would be. Errors: as read_records and copy_run().
std::vector<MergedCell> merge_runs(const fs::path& into, const fs::path& from, bool write);

// Run folders below `folder` whose records are not in its records.jsonl: their records join it.
std::vector<MergedCell> adopt_runs(const fs::path& folder, bool write);

// What differs between two records of a cell that should be the same; empty: nothing that is not
// the machine's (speed, time, memory). Where meshes of only one were made apart from its training
// (Record::meshes_made), those of neither are looked at.
std::string score_differences(const Record& a, const Record& b);

}  // namespace glint
