// SPDX-License-Identifier: MIT
#include "reports/show/tables/compare.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "glint/core/presence.h"
#include "metrics/metric.h"
#include "reports/show/tables/statistics.h"

namespace glint {

namespace {

constexpr double kRounding = 1e-12;  // relative; smaller differences are none

// Metric id -> which way is better, of every column of the tables.
const std::map<std::string, RankOrder>& table_metrics() {
  static const std::map<std::string, RankOrder> metrics = [] {
    std::map<std::string, RankOrder> found;
    for (const TableDefinition& definition : table_definitions())
      for (const TableColumn& column : definition.columns)
        if (!column.metric.empty()) found[column.metric] = column.order;
    return found;
  }();
  return metrics;
}

bool is_compared(const std::string& metric, const CompareOptions& options) {
  if (options.metrics.empty()) return table_metrics().count(metric) > 0;
  return std::any_of(options.metrics.begin(), options.metrics.end(), [&](const std::string& glob) {
    return glob_match(glob, metric);
  });
}

struct CellPair {
  const Record* before = nullptr;
  const Record* after = nullptr;
};

// Values over seeds of one metric, in the order of the cells.
struct SeedValues {
  std::vector<double> before, after;
};

class Comparer {
 public:
  explicit Comparer(const CompareOptions& options) : options_(options) {
    result_.tolerance = options.tolerance;
  }

  Comparison compare(const std::vector<Record>& before, const std::vector<Record>& after) {
    for (const CellPair& pair : matched(before, after)) add_cell(pair);
    for (const auto& [key, values] : values_) add_value(key, values);
    sort_values();
    result_.notes.assign(notes_.begin(), notes_.end());
    return std::move(result_);
  }

 private:
  using ValueKey = std::tuple<std::string, std::string, std::string>;  // scene, method, metric

  std::vector<CellPair> matched(
      const std::vector<Record>& before, const std::vector<Record>& after
  ) {
    std::map<CellKey, CellPair> cells;
    for (const Record& record : before) cells[record.cell].before = &record;
    for (const Record& record : after) cells[record.cell].after = &record;
    std::vector<CellPair> pairs;
    for (const auto& [key, pair] : cells) {
      if (!pair.after) result_.before_only.push_back(key);
      if (!pair.before) result_.after_only.push_back(key);
      if (pair.before && pair.after) pairs.push_back(pair);
    }
    result_.num_cells = pairs.size();
    return pairs;
  }

  void add_cell(const CellPair& pair) {
    const auto& [before, after] = pair;
    if (before->ok() && !after->ok())
      result_.cells.push_back(
          {after->cell,
           fmt::format("newly failed ({}: {})", after->failure->stage, after->failure->message),
           true}
      );
    if (!before->ok() && after->ok())
      result_.cells.push_back({after->cell, "failed before, finished now", false});
    if (!before->ok() || !after->ok()) return;
    note_differences(pair);
    for (const auto& [metric, value] : before->metrics)
      if (is_compared(metric, options_)) add_metric(pair, metric, value);
  }

  void add_metric(const CellPair& pair, const std::string& metric, double before) {
    const Record& after = *pair.after;
    if (const auto it = after.metrics.find(metric); it != after.metrics.end()) {
      SeedValues& values = values_[{after.cell.scene, after.cell.method, metric}];
      values.before.push_back(before);
      values.after.push_back(it->second);
      return;
    }
    const auto reason = after.not_measured.find(metric);
    const bool excused = reason != after.not_measured.end();
    result_.cells.push_back(
        {after.cell,
         fmt::format(
             "{} has no value any more ({})", metric, excused ? reason->second : "no reason"
         ),
         !excused}
    );
  }

  void note_differences(const CellPair& pair) {
    const auto& [before, after] = pair;
    const std::string& scene = after->cell.scene;
    const auto note = [&](const char* what, const std::string& a, const std::string& b) {
      if (a != b) notes_.insert(fmt::format("{}: {} differs: '{}', now '{}'", scene, what, a, b));
    };
    note("the data", before->dataset_hash, after->dataset_hash);
    note("the resolution", before->resolution, after->resolution);
    const auto device = [](const Record& record) {
      const Json name = record.environment.value("device", Json());
      return name.is_string() ? name.get<std::string>() : std::string();
    };
    note("the device", device(*before), device(*after));
  }

  void add_value(const ValueKey& key, const SeedValues& values) {
    ++result_.num_values;
    ValueChange change;
    std::tie(change.scene, change.method, change.metric) = key;
    change.before = mean_of(values.before);
    change.after = mean_of(values.after);
    change.num_seeds = static_cast<int>(values.before.size());
    const double size = std::max(std::abs(change.before), std::abs(change.after));
    if (std::abs(change.difference()) <= kRounding * size) return;
    change.allowed = change.num_seeds > 1
                         ? std::max(spread_of(values.before), spread_of(values.after))
                         : options_.tolerance * std::abs(change.before);
    change.order = metric_order(change.metric);
    change.verdict = verdict_of(change);
    change.regression =
        change.verdict == Verdict::kWorse && (options_.costs || !is_cost(change.metric));
    result_.values.push_back(change);
  }

  static Verdict verdict_of(const ValueChange& change) {
    if (std::abs(change.difference()) <= change.allowed) return Verdict::kWithinSpread;
    if (change.order == RankOrder::kNone) return Verdict::kOther;
    const bool higher = change.difference() > 0;
    return higher == (change.order == RankOrder::kHigherFirst) ? Verdict::kBetter : Verdict::kWorse;
  }

  void sort_values() {
    const auto size = [](const ValueChange& change) {
      const double difference = std::abs(change.difference());
      return change.allowed > 0 ? difference / change.allowed
                                : std::numeric_limits<double>::infinity();
    };
    std::stable_sort(
        result_.values.begin(),
        result_.values.end(),
        [&](const ValueChange& a, const ValueChange& b) {
          return std::tuple(!a.regression, a.verdict, -size(a)) <
                 std::tuple(!b.regression, b.verdict, -size(b));
        }
    );
  }

  const CompareOptions& options_;
  std::map<ValueKey, SeedValues> values_;
  std::set<std::string> notes_;
  Comparison result_;
};

}  // namespace

std::size_t Comparison::num_regressions() const {
  const auto regressed = [](const auto& change) { return change.regression; };
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), regressed) +
      std::count_if(cells.begin(), cells.end(), regressed)
  );
}

namespace {

fs::path file_at(const fs::path& path) {
  const fs::path file = is_folder(path) ? path / "records.jsonl" : path;
  GLINT_CHECK(
      is_file(file),
      kBadPrediction,
      "{}: no such file; expected a folder with records.jsonl or the file itself",
      file.string()
  );
  // Something else altogether is not read line by line, with a warning each.
  GLINT_CHECK(
      open_file(file).peek() == '{',
      kBadPrediction,
      "{}: holds no record; expected one JSON object a line (docs/reference/records.md)",
      file.string()
  );
  return file;
}

}  // namespace

fs::path store_file(const fs::path& path) {
  return with_exit_code(ExitCode::kBadPrediction, [&] { return file_at(path); });
}

std::vector<Record> read_store(const fs::path& path) {
  return with_exit_code(ExitCode::kBadPrediction, [&] {
    auto records = read_records(file_at(path));
    GLINT_CHECK(
        !records.empty(), kBadPrediction, "{}: holds no record that is whole", path.string()
    );
    return records;
  });
}

Comparison compare_records(
    const std::vector<Record>& before,
    const std::vector<Record>& after,
    const CompareOptions& options
) {
  return Comparer(options).compare(before, after);
}

RankOrder metric_order(const std::string& id) {
  if (const auto it = table_metrics().find(id); it != table_metrics().end()) return it->second;
  const Metric* metric = find_metric(id);
  if (!metric) return RankOrder::kNone;
  return metric->direction == Direction::kHigherIsBetter ? RankOrder::kHigherFirst
                                                         : RankOrder::kLowerFirst;
}

}  // namespace glint
