// SPDX-License-Identifier: MIT
#include "reports/show/tables/table_cells.h"

#include <algorithm>
#include <cmath>

#include "reports/show/tables/published.h"
#include "reports/show/tables/statistics.h"

namespace glint {

namespace {

// What a finished run says about why it has no value of the metric; empty: nothing.
std::string reason_of_absence(const RecordPointers& records, const std::string& metric) {
  for (const Record* record : records)
    if (const auto it = record->not_measured.find(metric);
        record->ok() && it != record->not_measured.end())
      return it->second;
  return {};
}

// Did the run say that there is no such value? Of a region: also where there is the value of whole
// pictures, but the data have no such region.
bool says_not_applicable(const Record& record, const std::string& metric) {
  const std::string whole = metric.substr(0, metric.find('@'));
  const auto& ids = record.not_applicable;
  return std::find(ids.begin(), ids.end(), whole) != ids.end() ||
         (whole != metric && record.metrics.contains(whole) && !record.metrics.contains(metric));
}

// Failed only where every run did: a finished one without the value says that it is not measured.
TableCell cell_without_values(const RecordPointers& records, const TableColumn& column) {
  TableCell cell;
  if (const std::string reason = reason_of_absence(records, column.metric); !reason.empty()) {
    cell.status = CellStatus::kUnavailable;
    cell.text = cell.note = reason;
    return cell;
  }
  const bool finished = std::any_of(records.begin(), records.end(), [](const Record* record) {
    return record->ok();
  });
  const bool applicable = std::none_of(records.begin(), records.end(), [&](const Record* record) {
    return record->ok() && says_not_applicable(*record, column.metric);
  });
  if (!records.empty() && !finished) {
    cell.status = CellStatus::kFailed;
    cell.note = failure_note(*records.front());
  } else if (!applicable) {
    cell.status = CellStatus::kNotApplicable;
    cell.note = "the method has no such map, or the data no truth for it";
  } else {
    cell.note = finished ? "not measured" : "not built or not run";
  }
  return cell;
}

bool has_metric(const RecordPointers& records, const std::string& metric) {
  return std::any_of(records.begin(), records.end(), [&](const Record* record) {
    return record->ok() && record->metrics.contains(metric);
  });
}

// The records that have a value of the metric, on these scenes or, where there is none, on any.
struct MeasuredRecords {
  RecordPointers records;
  bool apart = false;
};

MeasuredRecords records_with(
    const RecordPointers& records, const std::string& metric, const SizedScenes& common
) {
  MeasuredRecords all, found;
  for (const Record* record : records) {
    if (!record->ok() || !record->metrics.contains(metric)) continue;
    all.records.push_back(record);
    if (common.contains(sized_scene(*record))) found.records.push_back(record);
  }
  all.apart = true;
  return found.records.empty() ? all : found;
}

std::optional<Interval> interval_of(
    const std::map<std::pair<std::string, std::uint64_t>, double>& values
) {
  std::map<std::string, std::vector<double>> by_scene;
  for (const auto& [key, value] : values) by_scene[key.first].push_back(value);
  std::vector<std::vector<double>> scenes;
  for (auto& [scene, of_seeds] : by_scene) scenes.push_back(std::move(of_seeds));
  const std::size_t pairs = std::max(values.size(), kMinBootstrapPairs);
  return bootstrap_interval(scenes, std::min(kMeanResamples, kMeanDraws / pairs + 1));
}

// Means over scenes of each seed, then over seeds: of those that have the most scenes, since a seed
// of a single hard one would weigh as much as a seed of all.
void fill_means(
    TableCell& cell, const MeasuredRecords& measured, double scale, const std::string& metric
) {
  std::map<std::uint64_t, std::map<std::string, double>> scenes_of_seed;
  std::size_t most = 0;
  for (const Record* record : measured.records) {
    auto& scenes = scenes_of_seed[record->cell.seed];
    scenes[sized_scene(*record).text()] = record->metrics.at(metric) * scale;
    most = std::max(most, scenes.size());
  }
  std::erase_if(scenes_of_seed, [&](const auto& seed) { return seed.second.size() < most; });
  std::vector<double> seed_means;
  for (const auto& [seed, scenes] : scenes_of_seed) {
    std::vector<double> values;
    for (const auto& [scene, value] : scenes) {
      values.push_back(value);
      if (!measured.apart) cell.values[{scene, seed}] = value;
    }
    seed_means.push_back(mean_of(values));
  }
  cell.interval = interval_of(cell.values);
  cell.value = mean_of(seed_means);
  cell.spread = spread_of(seed_means);
  cell.num_scenes = static_cast<int>(most);
  cell.num_seeds = static_cast<int>(seed_means.size());
}

// Why the cell cannot be compared with the others; empty: it can.
std::string partial_note(
    const TableCell& cell, const MeasuredRecords& measured, std::size_t expected, bool eight_bit
) {
  std::vector<std::string> reasons;
  if (measured.apart) {
    SizedScenes scenes;
    for (const Record* record : measured.records) scenes.insert(sized_scene(*record));
    reasons.push_back("mean over " + scenes_text(scenes, true) + " only");
  } else if (cell.num_scenes < static_cast<int>(expected)) {
    reasons.push_back(fmt::format("mean over {} of {} scenes", cell.num_scenes, expected));
  }
  if (eight_bit) reasons.push_back("of 8-bit images (psnr-8bit)");
  return fmt::format("{}", fmt::join(reasons, ", "));
}

std::string text_field(const Record& record, const std::string& field) {
  if (field == "resolution") return record.resolution;
  const auto it = record.environment.find(field);
  return it != record.environment.end() && it->is_string() ? it->get<std::string>() : "";
}

}  // namespace

std::string format_value(double value, int decimals) {
  constexpr double kHuge = 1e7;
  return std::abs(value) < kHuge ? fmt::format("{:.{}f}", value, decimals)
                                 : fmt::format("{:.3e}", value);
}

std::string eight_bit_metric(const std::string& metric) {
  const std::string whole = metric.substr(0, metric.find('@'));
  return whole == "psnr" ? whole + "-8bit" + metric.substr(whole.size()) : "";
}

TableCell measured_cell(
    const RecordPointers& records, const TableColumn& column, const SizedScenes& common
) {
  const std::string other = eight_bit_metric(column.metric);
  const bool eight_bit = !has_metric(records, column.metric) && has_metric(records, other);
  const std::string& metric = eight_bit ? other : column.metric;
  const MeasuredRecords measured = records_with(records, metric, common);
  if (measured.records.empty()) return cell_without_values(records, column);
  TableCell cell;
  cell.apart = measured.apart;
  fill_means(cell, measured, column.scale, metric);
  cell.text = format_value(cell.value, column.decimals);
  cell.note = partial_note(cell, measured, common.size(), eight_bit);
  cell.status = cell.note.empty() ? CellStatus::kOk : CellStatus::kPartial;
  return cell;
}

TableCell text_cell(const RecordPointers& records, const TableColumn& column) {
  std::set<std::string> values;
  for (const Record* record : records)
    if (const std::string text = text_field(*record, column.field); record->ok() && !text.empty())
      values.insert(text);
  if (values.empty()) return cell_without_values(records, column);
  TableCell cell;
  cell.status = CellStatus::kOk;
  for (const std::string& value : values) cell.text += (cell.text.empty() ? "" : ", ") + value;
  return cell;
}

TableCell published_cell(
    const TableDefinition& definition, const TableColumn& column, const TableRowDefinition& row
) {
  TableCell cell;
  const PublishedValue* value =
      find_published(definition.paper_table, column.dataset, row.paper_row, column.paper_column);
  cell.status = value ? CellStatus::kOk : CellStatus::kNotApplicable;
  if (!value) return cell;
  cell.value = value->value;
  cell.text = value->text;
  cell.note = value->source;
  return cell;
}

std::string failure_note(const Record& record) {
  std::string note = fmt::format(
      "{} failed ({}: {})", record.cell.text(), record.failure->stage, record.failure->message
  );
  std::replace(note.begin(), note.end(), '\n', ' ');
  return note;
}

}  // namespace glint
