// SPDX-License-Identifier: MIT
#include "reports/executors/cell_queue.h"

#include <algorithm>

#include "glint/core/progress.h"
#include "glint/train/checkpoint.h"
#include "reports/bench/cell_stages.h"
#include "reports/bench/memory_estimate.h"
#include "reports/records/run_folder.h"

namespace glint {
namespace {

// Data that cannot be identified are for the cell to say so.
SceneIdentity identity_of(const RunnerOptions& options, const SceneSource& source) {
  try {
    return options.identify(source);
  } catch (const Error& error) {
    return {Json::object(), error.what()};
  }
}

}  // namespace

CellQueue::CellQueue(const std::vector<PlanCell>& plan, const RunnerOptions& options, int jobs)
    : num_cells_(plan.size()),
      jobs_(jobs),
      out_(options.out),
      records_(read_records(options.out / "records.jsonl")) {
  std::map<std::string, SceneIdentity> scenes;
  for (const PlanCell& cell : plan) {
    const auto [scene, is_new] = scenes.try_emplace(cell.cell.scene);
    if (is_new) scene->second = identity_of(options, cell.source);
    const fs::path run = options.force ? fs::path() : run_folder(out_, cell.cell);
    const CellStages stages =
        cell_stages(cell, options.profile, scene->second, find_record(records_, cell.cell), run);
    if (stages.done()) {
      ++num_done_;
      continue;
    }
    stages_[&cell] = stages_to_do(stages);
    waiting_.push_back({&cell, 1, options.force});
  }
  if (jobs > 1) sort_longest_first();
}

void CellQueue::sort_longest_first() {
  std::stable_sort(waiting_.begin(), waiting_.end(), [&](const CellTry& a, const CellTry& b) {
    return seconds_of(*a.cell).value_or(0) > seconds_of(*b.cell).value_or(0);
  });
}

std::vector<const PlanCell*> CellQueue::cells() const {
  std::vector<const PlanCell*> cells;
  for (const CellTry& what : waiting_) cells.push_back(what.cell);
  return cells;
}

CellTry CellQueue::take() {
  const CellTry what = waiting_.front();
  waiting_.pop_front();
  return what;
}

void CellQueue::put_back(const CellTry& what) {
  CellTry again = what;
  again.force = what.force && !fs::exists(run_folder(out_, what.cell->cell) / kCheckpointFile);
  waiting_.push_front(again);
}

bool CellQueue::postpone(const CellTry& what) {
  if (!postponed_.insert(what.cell).second) return false;
  waiting_.push_back(what);
  return true;
}

void CellQueue::learn(const Record& record) { records_.push_back(record); }

std::optional<double> CellQueue::seconds_of(const PlanCell& cell) const {
  const auto stages = stages_.find(&cell);
  if (stages == stages_.end()) return 0;
  return estimated_seconds(cell, records_, stages->second);
}

double CellQueue::bytes_of(const PlanCell& cell) const {
  double most = 0;
  for (const Record& record : records_)
    if (record.ok() && record.cell.method == cell.cell.method)
      most = std::max(most, bytes_taken(record));
  return most;
}

// Of those that wait; empty where one of them is of a method that has not been seen yet.
std::string CellQueue::time_left() const {
  double seconds = 0;
  for (const CellTry& what : waiting_) {
    const auto known = seconds_of(*what.cell);
    if (!known) return "";
    seconds += *known;
  }
  return waiting_.empty() ? "" : ", " + format_duration(seconds / jobs_) + " left behind it";
}

std::string CellQueue::place_of(const CellTry& what) const {
  const std::size_t place = num_cells_ - waiting_.size();
  const std::string again = what.number > 1 ? fmt::format(", try {}", what.number) : "";
  return fmt::format(
      "[{}/{}{}{}] {}", place, num_cells_, again, time_left(), what.cell->cell.text()
  );
}

}  // namespace glint
