// SPDX-License-Identifier: MIT
// Records of several stores side by side, in groups of what can be compared: a number stands beside
// others only where data, image size and steps of training are the same.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reports/run/records/records.h"

namespace glint {

struct BoardRecord {
  Record record;
  std::string store;   // as the page names it
  std::string commit;  // that trained it, or scored renders of others
  std::string date;    // "2026-11-26T01:16:56Z"; empty: not known
};

// Two stores that say different things of one cell by one commit; the first one's is kept.
struct Contradiction {
  CellKey cell;
  std::string kept, other;  // stores
  std::string why;
};

struct BoardGroup {
  std::string dataset, resolution;
  int steps = 0;                              // 0: the records do not say
  std::map<std::string, std::string> hashes;  // of the data, by scene
  int version = 1;                            // of several with other data: 1, 2, ...
  std::vector<BoardRecord> shown;             // one a cell
  std::vector<BoardRecord> all;               // earlier ones of the same cells, too, as read

  std::string title() const;            // "glassroom at 240x135, 3000 steps"
  std::vector<Record> records() const;  // those shown
};

struct BoardStore {
  std::string name;
  std::size_t num_records = 0;
};

struct Board {
  std::vector<BoardStore> stores;
  std::vector<BoardGroup> groups;  // the largest first
  std::vector<Contradiction> contradictions;
};

// `paths`: folders with records.jsonl, or such files; on the page they are named by the ends of
// their paths. Of a cell that several stores have, equal scores are one; of several commits
// the newest is shown, and the others are history; anything else is a contradiction (merge_runs.h).
// Renders of others, whose steps nobody knows, stand in every group of their data and size. Errors
// (kBadPrediction): no such store, one without records; (kUsage): a store twice.
Board make_board(const std::vector<std::string>& paths);

// "lab_a", or "lab_b/ci" beside "lab_c/ci": the ends of paths that tell them apart.
std::vector<std::string> store_names(const std::vector<std::string>& paths);

}  // namespace glint
