// SPDX-License-Identifier: MIT
#include "reports/run/executors/cell_queue.h"

#include <algorithm>

#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/train/checkpoint.h"
#include "reports/run/bench/cell_needs.h"
#include "reports/run/bench/cell_stages.h"
#include "reports/run/records/run_folder.h"

namespace glint {
namespace {

// How much of its training a run has in a checkpoint from which it would go on, from 0 to 1.
double trained_share(const fs::path& run, const StageState& train) try {
  const bool goes_on = !run.empty() && !train.done &&
                       is_checkpoint_of(run / kCheckpointFile, train.key()) &&
                       is_there(run / kProgressFile);
  if (!goes_on) return 0;
  const Json progress = parse_json(read_file(run / kProgressFile));
  const double of = number_or(progress, "of", 0), done = number_or(progress, "iterations", 0);
  return of > 0 ? std::clamp(done / of, 0.0, 1.0) : 0;
} catch (const Error&) {
  return 0;  // the cell will say so itself
}

}  // namespace

CellQueue::CellQueue(
    const std::vector<PlanCell>& plan, const RunnerOptions& options, CellOrder order
)
    : num_cells_(plan.size()),
      out_(options.out),
      profile_(options.profile),
      records_(read_records(options.out / "records.jsonl")) {
  std::map<std::string, SceneIdentity> scenes;
  for (const PlanCell& cell : plan) {
    const auto [scene, is_new] = scenes.try_emplace(cell.cell.scene);
    if (is_new) scene->second = identity_or_why(options.identify, cell.source);
    const fs::path run = options.force ? fs::path() : run_folder(out_, cell.cell);
    const CellStages stages =
        cell_stages(cell, options.profile, scene->second, find_record(records_, cell.cell), run);
    if (stages.done()) {
      ++num_done_;
      continue;
    }
    stages_[&cell] = stages_to_do(stages);
    trained_[&cell] = trained_share(run, stages[Stage::kTrain]);
    waiting_.push_back({&cell, 1, options.force});
  }
  if (order == CellOrder::kLongest)
    sort_longest_first();
  else
    sort_as_given(options.filter.cells);
}

void CellQueue::sort_longest_first() {
  std::stable_sort(waiting_.begin(), waiting_.end(), [&](const CellTry& a, const CellTry& b) {
    return seconds_of(*a.cell).value_or(0) > seconds_of(*b.cell).value_or(0);
  });
}

void CellQueue::sort_as_given(const std::vector<std::string>& cells) {
  std::map<std::string, std::size_t> places;
  for (const std::string& cell : cells) places.try_emplace(cell, places.size());
  const auto place = [&](const CellTry& what) {
    const auto found = places.find(what.cell->cell.text());
    return found == places.end() ? places.size() : found->second;
  };
  std::stable_sort(waiting_.begin(), waiting_.end(), [&](const CellTry& a, const CellTry& b) {
    return place(a) < place(b);
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

// What --force had to undo is undone where the cell has a checkpoint since then.
CellTry CellQueue::again(const CellTry& what) const {
  CellTry again = what;
  const fs::path checkpoint = run_folder(out_, what.cell->cell) / kCheckpointFile;
  again.force = what.force && !or_warn([&] { return is_there(checkpoint); });
  return again;
}

void CellQueue::put_back(const CellTry& what) { waiting_.push_front(again(what)); }

void CellQueue::put_last(const CellTry& what) { waiting_.push_back(again(what)); }

bool CellQueue::postpone(const CellTry& what) {
  if (!postponed_.insert(what.cell).second) return false;
  waiting_.push_back(what);
  return true;
}

void CellQueue::set_aside_longer_than(double seconds) {
  const auto first =
      std::stable_partition(waiting_.begin(), waiting_.end(), [&](const CellTry& what) {
        return seconds_of(*what.cell).value_or(0) <= seconds;
      });
  set_aside_.insert(set_aside_.end(), first, waiting_.end());
  waiting_.erase(first, waiting_.end());
}

std::optional<CellTry> CellQueue::shortest_set_aside() const {
  const auto found = std::ranges::min_element(set_aside_, {}, [&](const CellTry& what) {
    return seconds_of(*what.cell).value_or(0);
  });
  return found == set_aside_.end() ? std::nullopt : std::optional(*found);
}

void CellQueue::learn(const Record& record) { records_.push_back(record); }

std::optional<double> CellQueue::seconds_of(const PlanCell& cell) const {
  const auto stages = stages_.find(&cell);
  if (stages == stages_.end()) return 0;
  const auto seconds = estimated_seconds(cell, records_, stages->second);
  const double trained = trained_.at(&cell);
  if (!seconds || trained == 0) return seconds;
  return *seconds - trained * estimated_seconds(cell, records_, {"train"}).value_or(0);
}

double CellQueue::bytes_of(const PlanCell& cell) const {
  double most = 0;
  for (const Record& record : records_)
    if (record.ok() && record.cell.method == cell.cell.method)
      most = std::max(most, bytes_taken(record));
  return most;
}

double CellQueue::card_bytes_of(const PlanCell& cell) const {
  double of_method = 0, of_any = 0;  // megabytes
  for (const Record& record : records_) {
    const auto found = record.metrics.find("device-memory");
    if (!record.ok() || found == record.metrics.end()) continue;
    of_any = std::max(of_any, found->second);
    if (record.cell.method == cell.cell.method) of_method = std::max(of_method, found->second);
  }
  if (of_method == 0 && cell.source.made())
    return device_bytes_of_process(estimate_device_bytes(
        memory_user(cell.cell.method, cell.config, profile_), size_of(cell.source)
    ));
  const double known = of_method > 0 ? of_method : of_any;
  return known > 0 ? device_bytes_of_process(known * 1e6) : 0;
}

// Of those that wait; empty where one of them is of a method that has not been seen yet.
std::string CellQueue::time_left(int jobs) const {
  double seconds = 0;
  for (const CellTry& what : waiting_) {
    const auto known = seconds_of(*what.cell);
    if (!known) return "";
    seconds += *known;
  }
  return waiting_.empty() ? "" : ", " + format_duration(seconds / jobs) + " left behind it";
}

std::string CellQueue::place_of(const CellTry& what, int jobs) const {
  const std::size_t place = num_cells_ - waiting_.size() - set_aside_.size();
  const std::string again = what.number > 1 ? fmt::format(", try {}", what.number) : "";
  return fmt::format(
      "[{}/{}{}{}] {}", place, num_cells_, again, time_left(jobs), what.cell->cell.text()
  );
}

}  // namespace glint
