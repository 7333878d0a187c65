// SPDX-License-Identifier: MIT
// Two stores of records, before and after a change: what differs by more than seeds do.
#pragma once

#include <string>
#include <vector>

#include "reports/run/records/records.h"
#include "reports/show/tables/tables.h"

namespace glint {

struct CompareOptions {
  std::vector<std::string> metrics;  // globs of ids; empty: those of the tables
  double tolerance = 0.01;           // of |before|: may change where there is one seed
  bool costs = false;                // speed, time and memory can be regressions
};

enum class Verdict {
  kWorse,         // beyond the allowed change: a regression, unless it is a cost
  kBetter,        // beyond it
  kOther,         // beyond it; neither direction is better
  kWithinSpread,  // changed, not beyond it
};

// A metric of a scene and a method: means over the seeds that finished in both stores.
struct ValueChange {
  std::string scene, method, metric;
  double before = 0, after = 0;
  double allowed = 0;  // the larger seed spread of the two; one seed: tolerance x |before|
  int num_seeds = 0;
  RankOrder order = RankOrder::kNone;
  Verdict verdict = Verdict::kWithinSpread;
  bool regression = false;

  double difference() const { return after - before; }
};

// A cell in both stores that changed otherwise.
struct CellChange {
  CellKey cell;
  std::string what;  // why it failed, which metric it lost
  bool regression = false;
};

struct Comparison {
  std::vector<ValueChange> values;  // regressions, worse, better, other, within the spread;
                                    // among these, the largest in units of `allowed` first
  std::vector<CellChange> cells;    // newly failed and mended cells, lost values
  std::vector<CellKey> before_only, after_only;
  std::vector<std::string> notes;  // data, devices or resolutions that differ
  std::size_t num_cells = 0;       // in both stores
  std::size_t num_values = 0;      // compared; those that are equal are not listed
  double tolerance = 0;

  std::size_t num_regressions() const;
};

// The file of a store: `path` is a folder with records.jsonl, or such a file. Errors
// (kBadPrediction): it is missing or holds something else.
fs::path store_file(const fs::path& path);
// Its records. Errors (kBadPrediction): as above, or it holds no record.
std::vector<Record> read_store(const fs::path& path);

Comparison compare_records(
    const std::vector<Record>& before,
    const std::vector<Record>& after,
    const CompareOptions& options = {}
);

// Which way a metric is better, of a region, too; kNone where nobody says.
RankOrder metric_order(const std::string& id);

std::string comparison_text(const Comparison& comparison);
std::string comparison_markdown(const Comparison& comparison);  // for a pull request
Json comparison_json(const Comparison& comparison);

}  // namespace glint
