// SPDX-License-Identifier: MIT
// docs/results/RESULTS.md and the README's table, made from a committed file of records, so that
// neither can differ from what was measured.
#pragma once

#include <string>
#include <vector>

#include "reports/show/tables/tables.h"

namespace glint {

// A part of the page: a file of docs/results/parts, which says what the page shows of some records
// and says of them besides their tables. The first is the README's.
struct ResultsInfo {
  std::string records;               // "docs/results/small.jsonl"
  std::string command;               // that made them
  std::string remarks;               // what a reader has to know: what did not run, what was busy
  std::string title;                 // of their part of the page
  std::vector<std::string> tables;   // ids; empty: all in which something is measured
  std::vector<std::string> cells;    // globs of scene/method/seed; empty: all
  std::vector<std::string> without;  // metrics whose columns say nothing here, as "train-minutes"
  bool other_data = false;           // not our rooms: without published columns, captions and notes
  bool measured_alone = false;       // a study of some methods: no rows of those it leaves out
  template <class V>
  void visit(V&& v) {
    v("records", records, "file of the records");
    v("command", command, "that made them");
    v("remarks", remarks, "what a reader has to know");
    v("title", title, "of their part of the page");
    v("cells", cells, "globs of the scene/method/seed shown");
    v("without", without, "metrics without a column");
    v("measured_alone", measured_alone, "true: no rows of methods without records");
    v("other_data", other_data, "true: not our rooms");
    v("tables", tables, "ids of the tables shown");
  }
};

// The files of a project's parts, by number and name. Errors (kBadReference): there are none.
std::vector<fs::path> results_parts(const fs::path& root);
// Errors (kUsage): unknown fields; kBadReference: no such file.
ResultsInfo read_results_info(const fs::path& file);

// A part with what it shows; its facts are Markdown, one a line.
struct ResultsSection {
  std::string title;
  std::vector<std::string> facts;
  std::vector<Table> tables;
};
ResultsSection results_section(const ResultsInfo& info, std::vector<Record> records);
// Of a project's folder, all of them. Errors (kBadPrediction): no records.
std::vector<ResultsSection> results_sections(const fs::path& root);

// A part of docs/results/RESULTS.md: command, scenes, resolution, revisions, dates, machine,
// tables.
std::string results_part(const ResultsInfo& info, std::vector<Record> records);
// A table of data that are not our rooms: without what is said of those and published columns.
Table of_other_data(const Table& table);

// The whole page of a project's folder, from docs/results/. Errors (kBadPrediction): no records.
std::string results_markdown(const fs::path& root);

// The table that the README shows: five columns of the summary, and where it comes from.
std::string readme_results(const ResultsInfo& info, std::vector<Record> records);

// `readme` with what stands between its two markers replaced. Errors (kBadReference): no markers.
inline constexpr const char* kResultsBegin = "<!-- results: written by `glint-bench results` -->";
inline constexpr const char* kResultsEnd = "<!-- end of results -->";
std::string with_results(const std::string& readme, const std::string& results);

}  // namespace glint
