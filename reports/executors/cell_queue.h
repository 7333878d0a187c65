// SPDX-License-Identifier: MIT
// The cells that are still to be run, in which order, and how long that will take.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "reports/bench/runner.h"

namespace glint {

// One try at a cell.
struct CellTry {
  const PlanCell* cell = nullptr;
  int number = 1;      // 1: the first
  bool force = false;  // --force, of which nothing has been done yet
  bool alone = false;  // with no other beside it: memory was short
};

class CellQueue {
 public:
  // Of `plan`, which must outlive it, those cells that are not done: in its order where one runs at
  // a time, else the longest first. Errors: as SceneIdentifier, but for data that cannot be had:
  // their cells will say so.
  CellQueue(const std::vector<PlanCell>& plan, const RunnerOptions& options, int jobs);

  bool empty() const { return waiting_.empty(); }
  std::size_t size() const { return waiting_.size(); }
  int num_done() const { return num_done_; }  // before anything was run
  const CellTry& front() const { return waiting_.front(); }
  std::vector<const PlanCell*> cells() const;

  CellTry take();
  void put_back(const CellTry& what);  // to be the next
  bool postpone(const CellTry& what);  // to the end, once; false: it was there already
  void learn(const Record& record);    // for estimates

  // "[3/34, 12m 10s left behind it] room_1/glint/0".
  std::string place_of(const CellTry& what) const;
  // What the cell takes by what its method took before; 0: unknown.
  double bytes_of(const PlanCell& cell) const;
  // All stages of it; nothing: unknown.
  std::optional<double> seconds_of(const PlanCell& cell) const;

 private:
  void sort_longest_first();
  std::string time_left() const;

  std::size_t num_cells_;
  int jobs_, num_done_ = 0;
  fs::path out_;
  std::deque<CellTry> waiting_;
  std::map<const PlanCell*, std::vector<std::string>> stages_;  // to be done
  std::set<const PlanCell*> postponed_;
  std::vector<Record> records_;
};

}  // namespace glint
