// SPDX-License-Identifier: MIT
#include "reports/show/board/board_history.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "reports/run/records/record_facts.h"
#include "reports/show/tables/method_title.h"
#include "reports/show/tables/results_page.h"
#include "reports/show/tables/table_cells.h"

namespace glint {
namespace {

std::string day_of(const std::string& date) { return date.substr(0, date.find('T')); }

template <class T>
void add_once(std::vector<T>& list, const T& value) {
  if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
}

void add_record(const BoardRecord& one, BoardSource& source) {
  const std::string day = day_of(one.date);
  if (source.num_records == 0 || day < source.first_date) source.first_date = day;
  source.last_date = std::max(source.last_date, day);
  add_once(source.scenes, one.record.cell.scene);
  add_once(source.seeds, one.record.cell.seed);
  const std::string scored_by = environment_text(one.record, "git_revision");
  if (scored_by != one.commit) source.scored_by = scored_by;
  ++source.num_records;
}

// One commit of a method: its last record of each cell.
struct Commit {
  std::string id, date;  // of its first record
  std::vector<std::string> stores;
  std::map<CellKey, const Record*> records;
};

std::vector<Commit> commits_of(const BoardGroup& group, const std::string& method) {
  std::vector<Commit> commits;
  for (const BoardRecord& one : group.all) {
    if (one.record.cell.method != method || !one.record.ok()) continue;
    auto known = std::find_if(commits.begin(), commits.end(), [&](const Commit& commit) {
      return commit.id == one.commit;
    });
    if (known == commits.end())
      known = commits.insert(commits.end(), Commit{one.commit, one.date, {}, {}});
    known->date = std::min(known->date, one.date);
    add_once(known->stores, one.store);
    known->records[one.record.cell] = &one.record;
  }
  std::stable_sort(commits.begin(), commits.end(), [](const Commit& a, const Commit& b) {
    return a.date < b.date;
  });
  return commits;
}

// Of one column: the last value of each scene and seed so far.
using Latest = std::map<std::pair<std::string, std::uint64_t>, double>;

// The mean of the difference over the pairs (scene, seed) that an earlier commit has, too.
void fill_change(Latest& latest, HistoryValue& value) {
  double sum = 0;
  for (const auto& [key, number] : value.cell.values) {
    const auto [it, is_new] = latest.try_emplace(key, number);
    if (is_new) continue;
    sum += number - it->second;
    it->second = number;
    ++value.num_pairs;
  }
  if (value.num_pairs > 0) value.change = sum / value.num_pairs;
}

// `latest`: one a column, of the commits before.
std::vector<HistoryValue> values_of(
    const Commit& commit,
    const std::vector<const TableColumn*>& columns,
    const SizedScenes& scenes,
    std::vector<Latest>& latest
) {
  RecordPointers records;
  for (const auto& [cell, record] : commit.records) records.push_back(record);
  std::vector<HistoryValue> values;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    HistoryValue value{measured_cell(records, *columns[i], scenes), {}, 0};
    fill_change(latest[i], value);
    values.push_back(std::move(value));
  }
  return values;
}

SizedScenes all_scenes(const BoardGroup& group) {
  SizedScenes scenes;
  for (const BoardRecord& one : group.all) scenes.insert(sized_scene(one.record));
  return scenes;
}

}  // namespace

std::vector<const TableColumn*> measured_columns(const Table& table) {
  std::vector<const TableColumn*> columns;
  for (const TableColumn& column : table.columns)
    if (!column.published && !column.metric.empty()) columns.push_back(&column);
  return columns;
}

std::string BoardSource::dates() const {
  return first_date == last_date ? first_date : first_date + " to " + last_date;
}

std::string BoardSource::text() const {
  std::string text = fmt::format("{}, commit {}", store, commit.empty() ? "unknown" : commit);
  if (!device.empty()) text += ", " + device;
  if (!first_date.empty()) text += ", " + dates();
  return fmt::format("{}, {} ({} records)", text, fmt::join(scenes, ", "), num_records);
}

std::vector<BoardSource> board_sources(
    const BoardGroup& group, const std::string& method, const std::string& metric
) {
  std::map<std::tuple<std::string, std::string, std::string>, BoardSource> sources;
  for (const BoardRecord& one : group.shown) {
    const auto& metrics = one.record.metrics;
    const bool has_it =
        metric.empty() || metrics.contains(metric) || metrics.contains(eight_bit_metric(metric));
    if (one.record.cell.method != method || !has_it) continue;
    const std::string device = device_text(one.record);
    BoardSource& source = sources[{one.store, one.commit, device}];
    source.store = one.store;
    source.commit = one.commit;
    source.device = device;
    add_record(one, source);
  }
  std::vector<BoardSource> all;
  for (auto& [key, source] : sources) {
    std::sort(source.scenes.begin(), source.scenes.end());
    std::sort(source.seeds.begin(), source.seeds.end());
    all.push_back(std::move(source));
  }
  return all;
}

std::vector<HistoryEntry> board_history(const BoardGroup& group, const Table& table) {
  const auto columns = measured_columns(table);
  const SizedScenes scenes = all_scenes(group);
  std::vector<HistoryEntry> history;
  for (const TableRow& row : table.rows) {
    const std::vector<Commit> commits = commits_of(group, row.method);
    if (commits.size() < 2) continue;
    std::vector<Latest> latest(columns.size());
    for (const Commit& commit : commits)
      history.push_back(
          {row.method,
           row.title,
           commit.id,
           day_of(commit.date),
           commit.stores,
           values_of(commit, columns, scenes, latest)}
      );
  }
  return history;
}

Table board_table(const BoardGroup& group) {
  TableDefinition summary = table_definition("summary");
  const std::vector<Record> records = group.records();
  summary.leave_out.clear();
  keep_rows_with_records(summary, records);
  const bool is_ours = group.dataset == summary.dataset;
  Table table = build_table(summary, records);
  if (!is_ours) table = of_other_data(table);
  table.title = group.title();
  return table;
}

}  // namespace glint
