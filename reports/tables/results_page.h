// SPDX-License-Identifier: MIT
// docs/RESULTS.md and the README's table, made from a committed file of records, so that neither
// can differ from what was measured.
#pragma once

#include <string>
#include <vector>

#include "reports/tables/tables.h"

namespace glint {

// What the pages say besides the tables; docs/results/results.json.
struct ResultsInfo {
  std::string records;  // "docs/results/small.jsonl"
  std::string command;  // that made them
  std::string remarks;  // what a reader has to know: what did not run, what was busy
  template <class V>
  void visit(V&& v) {
    v("records", records, "file of the records");
    v("command", command, "that made them");
    v("remarks", remarks, "what a reader has to know");
  }
};

// Errors (kUsage): unknown fields; kBadReference: no such file.
ResultsInfo read_results_info(const fs::path& file);

// The whole of docs/RESULTS.md: command, scenes, resolution, revisions, dates, machine, all tables
// in which something is measured.
std::string results_markdown(const ResultsInfo& info, const std::vector<Record>& records);

// The table that the README shows, with one line on where it comes from.
std::string readme_results(const ResultsInfo& info, const std::vector<Record>& records);

// `readme` with what stands between its two markers replaced. Errors (kBadReference): no markers.
inline constexpr const char* kResultsBegin = "<!-- results: written by `glint-bench results` -->";
inline constexpr const char* kResultsEnd = "<!-- end of results -->";
std::string with_results(const std::string& readme, const std::string& results);

}  // namespace glint
