// SPDX-License-Identifier: MIT
#include "reports/show/tables/training_notes.h"

#include <algorithm>
#include <map>
#include <set>

namespace glint {
namespace {

// Rows are compared as if they were trained alike.
void add_steps_note(Table& table, const std::vector<Record>& records) {
  std::map<int, std::vector<std::string>> titles;  // by steps
  for (const TableRow& row : table.rows) {
    std::set<int> steps;
    for (const Record& record : records)
      if (record.cell.method == row.method && record.ok() && record.iterations > 0)
        steps.insert(record.iterations);
    for (const int count : steps) titles[count].push_back(row.title);
  }
  if (titles.size() < 2) return;
  std::vector<std::string> groups;
  for (const auto& [steps, rows] : titles)
    groups.push_back(fmt::format("{}: {}", steps, fmt::join(rows, ", ")));
  table.notes.push_back(
      fmt::format("Trained for different numbers of steps ({}).", fmt::join(groups, "; "))
  );
}

// With 42 photos a method without reflections gave what panes hide the colours that they mirror,
// more so with more steps (docs/design/glint.md), and the order by pictures was another.
void add_photos_note(Table& table, const std::vector<Record>& records) {
  constexpr int kPublished = 156;
  std::set<int> photos;
  for (const Record& record : records)
    if (record.ok() && record.training_views > 0) photos.insert(record.training_views);
  if (photos.empty()) return;
  const int fewest = *photos.begin(), most = *photos.rbegin();
  const std::string few = fmt::format(
      " (a scene of 3D-FRONT-T: {}); with so few, the order by pictures can be another", kPublished
  );
  table.notes.push_back(fmt::format(
      "Photos for training, a scene: {}{}.",
      fewest == most ? std::to_string(most) : fmt::format("{} to {}", fewest, most),
      fewest < kFewPhotos ? few : ""
  ));
}

}  // namespace

void warn_of_short_runs(Table& table, const std::vector<Record>& records) {
  constexpr int kLong = 8000;
  int most = 0;
  for (const Record& record : records)
    if (record.ok()) most = std::max(most, record.iterations);
  if (most == 0 || most >= kLong) return;
  table.title += fmt::format(" (a smoke test: {} steps)", most);
  table.caption = fmt::format(
      "A smoke test: {} steps, of published 30,000 and more, at which the order can be another. {}",
      most,
      table.caption
  );
}

void add_training_notes(Table& table, const std::vector<Record>& records) {
  add_steps_note(table, records);
  add_photos_note(table, records);
}

}  // namespace glint
