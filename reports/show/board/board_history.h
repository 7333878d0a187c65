// SPDX-License-Identifier: MIT
// Of a group of a board: where each number came from, and how a method's means changed over
// commits.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "reports/show/board/board_records.h"
#include "reports/show/tables/tables.h"

namespace glint {

// Records of a method by one store, commit and device.
struct BoardSource {
  std::string store, commit, device;
  std::string first_date, last_date;  // "2026-11-26"
  std::string scored_by;              // revision, where it is another than `commit`
  std::vector<std::string> scenes;
  std::vector<std::uint64_t> seeds;
  std::size_t num_records = 0;

  std::string dates() const;  // "2026-11-26 to 2026-11-27"
  std::string text() const;   // "lab_a, commit abc, AMD EPYC, 2026-11-26, room_1 (3 records)"
};

// The columns that are measured, whose values the history has.
std::vector<const TableColumn*> measured_columns(const Table& table);

// Of the method's shown records; with a metric, of those that have it.
std::vector<BoardSource> board_sources(
    const BoardGroup& group, const std::string& method, const std::string& metric = ""
);

struct HistoryValue {
  TableCell cell;  // mean of this commit, as tables have it
  // Over scenes and seeds that earlier commits have, too: since the last of them, each.
  std::optional<double> change;
  int num_pairs = 0;  // of them
};

struct HistoryEntry {
  std::string method, title, commit, date;
  std::vector<std::string> stores;
  std::vector<HistoryValue> values;  // one a measured column of the table
};

// Methods with records of several commits, each with its commits by the date of the first record.
std::vector<HistoryEntry> board_history(const BoardGroup& group, const Table& table);

// The group's summary: the table of that name, of the methods that have records.
Table board_table(const BoardGroup& group);

}  // namespace glint
