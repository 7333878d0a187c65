// SPDX-License-Identifier: MIT
#include "reports/show/tables/tables.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "glint/method.h"
#include "reports/run/records/cell_filter.h"
#include "reports/run/records/lossy_renders.h"
#include "reports/run/records/manifest.h"
#include "reports/show/tables/method_title.h"
#include "reports/show/tables/published.h"
#include "reports/show/tables/statistics.h"
#include "reports/show/tables/table_cells.h"
#include "reports/show/tables/training_notes.h"

namespace glint {

namespace {

// Behind the title of a row that is no rival.
constexpr std::string_view kNoRival = "‡";

std::string dataset_title_of(const TableDefinition& definition, const std::string& dataset) {
  if (dataset == definition.dataset) return definition.dataset_title;
  const Manifest* manifest = find_manifest(dataset);
  return manifest == nullptr ? dataset : manifest->title;
}

TableColumn published_column(
    const TableColumn& measured, const std::string& dataset, const PublishedValue& sample
) {
  TableColumn column = measured;
  column.id = fmt::format("published/{}/{}", dataset, measured.paper_column);
  column.group = dataset;
  column.dataset = dataset;
  column.metric.clear();
  if (!measured.paper_title.empty()) column.title = measured.paper_title;
  // Times are printed as the paper has them, with their unit in the cell.
  column.unit = sample.unit == "1" || sample.unit == "min" ? "" : sample.unit;
  column.decimals = sample.decimals;
  column.published = true;
  return column;
}

// The paper's numbers of one of its datasets; columns it does not have are left out.
void add_published_columns(
    const TableDefinition& definition, const std::string& dataset, std::vector<TableColumn>& columns
) {
  for (const TableColumn& measured : definition.columns)
    for (const PublishedValue& value : published_values())
      if (value.table == definition.paper_table && value.dataset == dataset &&
          value.column == measured.paper_column) {
        columns.push_back(published_column(measured, dataset, value));
        break;
      }
}

bool has_value(
    const std::vector<Record>& records, const std::string& dataset, const std::string& metric
) {
  return std::any_of(records.begin(), records.end(), [&](const Record& record) {
    return record.dataset == dataset && record.ok() && record.metrics.contains(metric);
  });
}

// The table's own dataset, then those of the records that have a value for the column.
std::vector<TableColumn> columns_of(
    const TableDefinition& definition, const std::vector<Record>& records
) {
  std::vector<TableColumn> columns = definition.columns;
  std::erase_if(columns, [&](const TableColumn& column) {
    return column.where_measured && !has_value(records, definition.dataset, column.metric);
  });
  std::set<std::string> further;
  for (const Record& record : records)
    if (record.dataset != definition.dataset) further.insert(record.dataset);
  for (const std::string& dataset : further)
    for (TableColumn column : definition.columns) {
      if (!has_value(records, dataset, column.metric)) continue;
      column.id = fmt::format("{}/{}", dataset, column.id);
      column.dataset = dataset;
      column.group = dataset_title_of(definition, dataset);
      columns.push_back(column);
    }
  for (const std::string& dataset : definition.paper_datasets)
    add_published_columns(definition, dataset, columns);
  return columns;
}

bool is_imported(const std::vector<Record>& records, const std::string& method) {
  return std::any_of(records.begin(), records.end(), [&](const Record& record) {
    return record.cell.method == method && !record.imported.empty();
  });
}

bool is_lossy(const std::vector<Record>& records, const std::string& method) {
  return std::ranges::any_of(records, [&](const Record& record) {
    return record.cell.method == method &&
           std::ranges::any_of(record.warnings, [](const std::string& warning) {
             return warning.find(kLossyRenders) != std::string::npos;
           });
  });
}

// Those of the definition, then every other method with records that it does not leave out.
std::vector<TableRowDefinition> rows_of(
    const TableDefinition& definition, const std::vector<Record>& records
) {
  std::vector<TableRowDefinition> rows = definition.rows;
  std::set<std::string> listed;
  for (const TableRowDefinition& row : rows) listed.insert(row.method);
  std::set<std::string> extra;
  for (const Record& record : records)
    if (!listed.contains(record.cell.method) &&
        !any_glob_matches(definition.leave_out, record.cell.method))
      extra.insert(record.cell.method);
  for (const std::string& method : extra) rows.push_back({method, method_title(method), ""});
  for (TableRowDefinition& row : rows) {
    if (is_imported(records, row.method))
      row.title +=
          is_lossy(records, row.method) ? " (renders imported as JPEG)" : " (renders imported)";
    if (!is_rival(row.method)) row.title += kNoRival;
  }
  return rows;
}

// Other methods have no say in which scenes are common.
std::vector<Record> records_of(
    const std::vector<TableRowDefinition>& rows, const std::vector<Record>& records
) {
  std::vector<Record> found;
  std::copy_if(
      records.begin(),
      records.end(),
      std::back_inserter(found),
      [&](const Record& record) {
        return std::any_of(rows.begin(), rows.end(), [&](const TableRowDefinition& row) {
          return row.method == record.cell.method;
        });
      }
  );
  return found;
}

// Those that decide what is compared; of a table without any, all.
std::vector<Record> records_of_rivals(const std::vector<Record>& records) {
  std::vector<Record> rivals = records;
  std::erase_if(rivals, [](const Record& record) { return !is_rival(record.cell.method); });
  return rivals.empty() ? records : rivals;
}

// The scenes of each column's means: those common to the methods, where any has the metric.
std::vector<SizedScenes> scenes_of_columns(
    const std::vector<TableColumn>& columns, const std::vector<Record>& records
) {
  const auto common = common_scenes(records_of_rivals(records));
  std::vector<SizedScenes> scenes(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto of_dataset = common.find(columns[i].dataset);
    if (columns[i].published || of_dataset == common.end()) continue;
    for (const Record& record : records)
      if (record.dataset == columns[i].dataset && record.metrics.contains(columns[i].metric) &&
          of_dataset->second.contains(sized_scene(record)))
        scenes[i].insert(sized_scene(record));
  }
  return scenes;
}

TableRow build_row(
    const TableDefinition& definition,
    const TableRowDefinition& row,
    const Table& table,
    const std::vector<SizedScenes>& scenes,
    const std::vector<Record>& records
) {
  TableRow result{row.method, row.title, {}, is_rival(row.method)};
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const TableColumn& column = table.columns[i];
    if (column.published) {
      result.cells.push_back(published_cell(definition, column, row));
      continue;
    }
    RecordPointers matching;
    for (const Record& record : records)
      if (record.dataset == column.dataset && record.cell.method == row.method)
        matching.push_back(&record);
    result.cells.push_back(
        column.metric.empty() ? text_cell(matching, column)
                              : measured_cell(matching, column, scenes[i])
    );
  }
  return result;
}

// Is all that it has measured of other scenes or sizes than the others' means?
bool is_apart(const TableRow& row, const Table& table) {
  bool apart = false;
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    const TableColumn& column = table.columns[i];
    if (column.published || column.metric.empty() || !row.cells[i].has_value()) continue;
    if (!row.cells[i].apart) return false;
    apart = true;
  }
  return apart;
}

bool can_rank(const TableRow& row, std::size_t column) {
  return row.rival && row.cells[column].status == CellStatus::kOk;
}

// 1 for the best; equal values share a rank and the next one is skipped. Methods beyond the paper's
// rows (controls, variants) are ranked too: they are results like any other.
void rank_column(Table& table, std::size_t column) {
  const RankOrder order = table.columns[column].order;
  std::vector<double> values;
  for (const TableRow& row : table.rows)
    if (can_rank(row, column)) values.push_back(row.cells[column].value);
  if (order == RankOrder::kNone || values.size() < 2) return;
  for (TableRow& row : table.rows) {
    TableCell& cell = row.cells[column];
    if (!can_rank(row, column)) continue;
    const auto better = std::count_if(values.begin(), values.end(), [&](double other) {
      return order == RankOrder::kHigherFirst ? other > cell.value : other < cell.value;
    });
    cell.rank = better < 3 ? static_cast<int>(better) + 1 : 0;
  }
}

const TableCell* first_of(const Table& table, std::size_t column) {
  for (const TableRow& row : table.rows)
    if (row.cells[column].rank == 1) return &row.cells[column];
  return nullptr;
}

// Of the scenes and seeds that both cells have, by scene.
std::vector<std::vector<double>> paired_differences(const TableCell& a, const TableCell& b) {
  std::map<std::string, std::vector<double>> by_scene;
  for (const auto& [key, value] : a.values)
    if (const auto it = b.values.find(key); it != b.values.end())
      by_scene[key.first].push_back(value - it->second);
  std::vector<std::vector<double>> differences;
  for (auto& [scene, values] : by_scene) differences.push_back(std::move(values));
  return differences;
}

// Whether second places can be told from first ones.
struct TieTests {
  int tied = 0, too_few_pairs = 0;
};

void mark_ties(Table& table, std::size_t column, TieTests& tests) {
  const TableCell* first = first_of(table, column);
  for (TableRow& row : table.rows) {
    TableCell& cell = row.cells[column];
    if (cell.rank != 2) continue;
    const auto interval = bootstrap_interval(paired_differences(*first, cell));
    cell.tied = interval && interval->contains(0);
    tests.tied += cell.tied;
    tests.too_few_pairs += !interval;
  }
}

// Against the first published group, the paper's counterpart of the data.
void add_agreement(Table& table, std::size_t measured, const std::string& paper_dataset) {
  std::optional<OrderAgreement> agreement =
      order_agreement(compared_methods(table, measured, paper_dataset));
  if (!agreement) return;
  agreement->column = table.columns[measured].id;
  table.agreement.push_back(*std::move(agreement));
}

std::string agreement_note(const OrderAgreement& order) {
  const std::string interval =
      order.interval
          ? fmt::format(
                ", 95 % interval over scenes and seeds {:.2f} to {:.2f}",
                order.interval->low,
                order.interval->high
            )
          : fmt::format(", fewer than {} pairs of scene and seed: no interval", kMinBootstrapPairs);
  return fmt::format(
      "Kendall's tau of the method order, measured against published, {}: {:.2f} ({} methods{}; 95 "
      "% "
      "of random orders lie within ±{:.2f}).",
      order.column,
      order.tau,
      order.num_methods,
      interval,
      order.chance.high
  );
}

std::string counted(std::size_t number, std::string_view what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

void add_tie_notes(Table& table, const TieTests& tests) {
  if (tests.tied > 0)
    table.notes.push_back(fmt::format(
        "≈ tied with the first: the paired bootstrap interval (95 %, {} resamples over scenes and "
        "seeds) of the difference contains zero.",
        kBootstrapResamples
    ));
  if (tests.too_few_pairs > 0)
    table.notes.push_back(fmt::format(
        "Fewer than {} pairs of scene and seed: no interval, so no claim about ties.",
        kMinBootstrapPairs
    ));
}

// What is said of rows: each once, in the order in which it is first said, with their titles.
class RowNotes {
 public:
  void add(const std::string& title, const std::string& note) {
    auto said =
        std::find_if(all_.begin(), all_.end(), [&](const auto& a) { return a.note == note; });
    if (said == all_.end()) said = all_.insert(all_.end(), Said{note, {}});
    auto& titles = said->titles;
    if (std::find(titles.begin(), titles.end(), title) == titles.end()) titles.push_back(title);
  }

  void append_to(Table& table, const std::string& before, const std::string& after) const {
    for (const auto& [note, titles] : all_)
      table.notes.push_back(fmt::format("{}{}: {}{}.", before, fmt::join(titles, ", "), note, after)
      );
  }

 private:
  struct Said {
    std::string note;
    std::vector<std::string> titles;
  };
  std::vector<Said> all_;
};

void add_method_notes(Table& table, const std::vector<Record>& records) {
  RowNotes notes;
  for (const TableRow& row : table.rows)
    for (const Record& record : records)
      if (record.cell.method == row.method)
        for (const std::string& note : record.notes) notes.add(row.title, note);
  notes.append_to(table, "", "");
}

void add_failures(Table& table, const std::vector<Record>& records) {
  std::set<std::string> failures;
  for (const Record& record : records)
    for (const TableRow& row : table.rows)
      if (!record.ok() && record.cell.method == row.method) failures.insert(failure_note(record));
  table.notes.insert(table.notes.end(), failures.begin(), failures.end());
}

void add_no_rival_notes(Table& table) {
  for (const TableRow& row : table.rows)
    if (!row.rival)
      table.notes.push_back(fmt::format(
          "{} {}: {}; not ranked.",
          kNoRival,
          row.title.substr(0, row.title.size() - kNoRival.size()),
          find_method(row.method).description
      ));
}

// What was drawn anew for the intervals of means.
void add_interval_note(Table& table) {
  int scenes = 0, seeds = 0;
  for (const TableRow& row : table.rows)
    for (const TableCell& cell : row.cells)
      if (cell.interval) {
        scenes = std::max(scenes, cell.num_scenes);
        seeds = std::max(seeds, cell.num_seeds);
      }
  if (scenes == 0) return;
  std::vector<const char*> drawn;
  if (scenes > 1) drawn.push_back("scenes");
  if (seeds > 1) drawn.push_back("seeds");
  table.notes.push_back(fmt::format(
      "{} 95 % by bootstrap over {}, too narrow where they are few. Rows share scenes: two methods "
      "may differ although these overlap.",
      kIntervalNote,
      fmt::join(drawn, " and ")
  ));
}

// What the cells with an asterisk are means of.
void add_partial_notes(Table& table) {
  RowNotes reasons;
  for (const TableRow& row : table.rows)
    for (const TableCell& cell : row.cells)
      if (cell.status == CellStatus::kPartial) reasons.add(row.title, cell.note);
  reasons.append_to(table, "* ", "; not ranked");
}

// Scenes that some methods have beyond those of the means.
SizedScenes left_out(
    const std::vector<Record>& records, const std::string& dataset, const SizedScenes& common
) {
  SizedScenes scenes;
  for (const Record& record : records)
    if (record.ok() && record.dataset == dataset && !common.contains(sized_scene(record)))
      scenes.insert(sized_scene(record));
  return scenes;
}

// Which scenes the means are taken over.
void add_scenes_note(
    Table& table, const TableDefinition& definition, const std::vector<Record>& records
) {
  std::set<std::uint64_t> seeds;
  for (const Record& record : records) seeds.insert(record.cell.seed);
  const SizedScenes common = common_scenes(records_of_rivals(records))[definition.dataset];
  const SizedScenes others = left_out(records, definition.dataset, common);
  const std::string scenes = scenes_text(common, !others.empty());
  table.notes.push_back(fmt::format(
      "Mean over test views, then {} ({}), then {}.{}",
      counted(common.size(), "scene"),
      common.empty() ? "none run yet" : scenes,
      counted(seeds.size(), "seed"),
      seeds.size() > 1 ? " ±: standard deviation over seeds, of two their range." : ""
  ));
  if (!others.empty())
    table.notes.push_back(fmt::format(
        "Not in these means, as too few methods have them: {}.", scenes_text(others, true)
    ));
}

// Rows that have fewer seeds than others in some column.
void add_seeds_notes(Table& table) {
  int most = 0;
  for (const TableRow& row : table.rows)
    for (const TableCell& cell : row.cells) most = std::max(most, cell.num_seeds);
  RowNotes notes;
  for (const TableRow& row : table.rows) {
    int fewest = most;
    for (const TableCell& cell : row.cells)
      if (cell.num_seeds > 0) fewest = std::min(fewest, cell.num_seeds);
    const std::string of_all = counted(static_cast<std::size_t>(most), "seed");
    if (fewest < most) notes.add(row.title, fmt::format("{} of {}", fewest, of_all));
  }
  notes.append_to(table, "", "");
}

// Where what a machine lacked is to be had.
void add_weights_note(Table& table) {
  const auto lacks = [](const TableCell& cell) {
    return cell.status == CellStatus::kUnavailable && cell.text == "no weights";
  };
  const bool any = std::any_of(table.rows.begin(), table.rows.end(), [&](const TableRow& row) {
    return std::any_of(row.cells.begin(), row.cells.end(), lacks);
  });
  if (any)
    table.notes.emplace_back(
        "no weights: scripts/fetch_lpips_weights.sh fetches those of LPIPS, and the next "
        "`glint-bench all` scores again."
    );
}

// Ours are simulated, whatever is measured on them.
void add_priors_note(Table& table, const std::vector<Record>& records) {
  if (std::any_of(records.begin(), records.end(), [](const Record& record) {
        return record.dataset == "glassroom";
      }))
    table.notes.emplace_back("GlassRoom: our own rooms; their priors are simulated.");
}

void add_notes(
    Table& table, const TableDefinition& definition, const std::vector<Record>& records
) {
  add_scenes_note(table, definition, records);
  add_interval_note(table);
  add_priors_note(table, records);
  add_seeds_notes(table);
  add_training_notes(table, records);
  add_failures(table, records);
  add_method_notes(table, records);
  add_weights_note(table);
  for (const OrderAgreement& order : table.agreement) table.notes.push_back(agreement_note(order));
}

}  // namespace

Table build_table(const TableDefinition& definition, const std::vector<Record>& all_records) {
  Table table{definition.id, definition.title, definition.caption, {}, {}, {}, {}};
  const std::vector<TableRowDefinition> rows = rows_of(definition, all_records);
  const std::vector<Record> records = records_of(rows, all_records);
  warn_of_short_runs(table, records);
  table.columns = columns_of(definition, records);
  const std::vector<SizedScenes> scenes = scenes_of_columns(table.columns, records);
  for (const TableRowDefinition& row : rows)
    table.rows.push_back(build_row(definition, row, table, scenes, records));
  std::stable_partition(table.rows.begin(), table.rows.end(), [&](const TableRow& row) {
    return !is_apart(row, table);
  });
  std::stable_partition(table.rows.begin(), table.rows.end(), [](const TableRow& row) {
    return row.rival;
  });
  TieTests ties;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].published) continue;
    rank_column(table, i);
    mark_ties(table, i, ties);
    if (!table.columns[i].paper_column.empty() && !definition.paper_datasets.empty() &&
        table.columns[i].dataset == definition.dataset)
      add_agreement(table, i, definition.paper_datasets.front());
  }
  add_notes(table, definition, records);
  add_tie_notes(table, ties);
  add_no_rival_notes(table);
  add_partial_notes(table);
  return table;
}

std::vector<ComparedMethod> compared_methods(
    const Table& table, std::size_t measured, const std::string& paper_dataset
) {
  const std::string published_id =
      fmt::format("published/{}/{}", paper_dataset, table.columns[measured].paper_column);
  const auto it =
      std::find_if(table.columns.begin(), table.columns.end(), [&](const TableColumn& column) {
        return column.id == published_id;
      });
  if (it == table.columns.end()) return {};
  const auto published = static_cast<std::size_t>(it - table.columns.begin());
  std::vector<ComparedMethod> methods;
  for (const TableRow& row : table.rows)
    if (can_rank(row, measured) && row.cells[published].status == CellStatus::kOk)
      methods.push_back(
          {row.cells[measured].value, row.cells[published].value, row.cells[measured].values}
      );
  return methods;
}

void keep_rows_with_records(TableDefinition& definition, const std::vector<Record>& records) {
  std::erase_if(definition.rows, [&](const TableRowDefinition& row) {
    return std::none_of(records.begin(), records.end(), [&](const Record& record) {
      return record.cell.method == row.method;
    });
  });
}

bool has_measurement(const Table& table) {
  for (const TableRow& row : table.rows)
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      if (!table.columns[i].published && row.cells[i].has_value()) return true;
  return false;
}

std::string_view order_arrow(RankOrder order) {
  if (order == RankOrder::kHigherFirst) return "↑";
  return order == RankOrder::kLowerFirst ? "↓" : "";
}

}  // namespace glint
