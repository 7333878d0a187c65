// SPDX-License-Identifier: MIT
// The cells that are still to be run, in which order, and how long that will take.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "reports/run/executors/executor.h"

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
  // Of `plan`, which must outlive it, those cells that are not done. Errors: as SceneIdentifier,
  // but for data that cannot be had: their cells will say so.
  CellQueue(const std::vector<PlanCell>& plan, const RunnerOptions& options, CellOrder order);

  bool empty() const { return waiting_.empty(); }
  std::size_t size() const { return waiting_.size(); }
  int num_done() const { return num_done_; }  // before anything was run
  const CellTry& front() const { return waiting_.front(); }
  std::vector<const PlanCell*> cells() const;

  CellTry take();
  void put_back(const CellTry& what);  // to be the next
  void put_last(const CellTry& what);  // behind all others
  bool postpone(const CellTry& what);  // to the end, once; false: it was there already
  // Those that are known to take longer wait no more; they come back in no way.
  void set_aside_longer_than(double seconds);
  const std::vector<CellTry>& set_aside() const { return set_aside_; }
  std::optional<CellTry> shortest_set_aside() const;  // nothing: there is none
  void learn(const Record& record);                   // for estimates

  // "[3/34, 12m 10s left behind it] room_1/glint/0", where `jobs` run at a time.
  std::string place_of(const CellTry& what, int jobs) const;
  // What the cell takes by what its method took before; 0: unknown.
  double bytes_of(const PlanCell& cell) const;
  // Of the card's memory, all that its process has there; 0: unknown.
  double card_bytes_of(const PlanCell& cell) const;
  // All stages of it that are to be done, less what a checkpoint has of its training; nothing:
  // unknown.
  std::optional<double> seconds_of(const PlanCell& cell) const;

 private:
  void sort_longest_first();
  void sort_as_given(const std::vector<std::string>& cells);
  CellTry again(const CellTry& what) const;
  std::string time_left(int jobs) const;

  std::size_t num_cells_;
  int num_done_ = 0;
  fs::path out_;
  const Profile& profile_;
  std::deque<CellTry> waiting_;
  std::vector<CellTry> set_aside_;
  std::map<const PlanCell*, std::vector<std::string>> stages_;  // to be done
  std::map<const PlanCell*, double> trained_;                   // how much of the training is done
  std::set<const PlanCell*> postponed_;
  std::vector<Record> records_;
};

}  // namespace glint
