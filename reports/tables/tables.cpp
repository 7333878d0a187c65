// SPDX-License-Identifier: MIT
#include "reports/tables/tables.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "reports/tables/method_title.h"
#include "reports/tables/published.h"
#include "reports/tables/statistics.h"

namespace glint {

namespace {

using RecordPointers = std::vector<const Record*>;

std::string dataset_title_of(const TableDefinition& definition, const std::string& dataset) {
  return dataset == definition.dataset ? definition.dataset_title : dataset;
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

std::vector<TableColumn> columns_of(
    const TableDefinition& definition, const std::vector<Record>& records
) {
  std::vector<TableColumn> columns = definition.columns;
  std::set<std::string> further;
  for (const Record& record : records)
    if (record.dataset != definition.dataset) further.insert(record.dataset);
  if (!definition.every_dataset) further.clear();
  for (const std::string& dataset : further)
    for (TableColumn column : definition.columns) {
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

std::vector<TableRowDefinition> rows_of(
    const TableDefinition& definition, const std::vector<Record>& records
) {
  std::vector<TableRowDefinition> rows = definition.rows;
  std::set<std::string> listed, extra;
  for (const TableRowDefinition& row : rows) listed.insert(row.method);
  const auto is_other = [&](const Record& record) {
    return (definition.imported && !record.imported.empty()) ||
           std::any_of(
               definition.other_methods.begin(),
               definition.other_methods.end(),
               [&](const std::string& glob) { return glob_match(glob, record.cell.method); }
           );
  };
  for (const Record& record : records)
    if (!listed.count(record.cell.method) && is_other(record)) extra.insert(record.cell.method);
  for (const std::string& method : extra) rows.push_back({method, method_title(method), ""});
  for (TableRowDefinition& row : rows)
    if (is_imported(records, row.method)) row.title += " (renders imported)";
  return rows;
}

std::set<std::string> scenes_of(const std::vector<Record>& records, const std::string& dataset) {
  std::set<std::string> scenes;
  for (const Record& record : records)
    if (record.dataset == dataset) scenes.insert(record.cell.scene);
  return scenes;
}

std::string failure_note(const Record& record) {
  std::string note = fmt::format(
      "{} failed ({}: {})", record.cell.text(), record.failure->stage, record.failure->message
  );
  std::replace(note.begin(), note.end(), '\n', ' ');
  return note;
}

std::string format_value(double value, const TableColumn& column) {
  return fmt::format("{:.{}f}", value, column.decimals);
}

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

// Scenes first, then seeds. `expected`: scenes that any method has.
TableCell measured_cell(
    const RecordPointers& records, const TableColumn& column, std::size_t expected
) {
  TableCell cell;
  std::map<std::uint64_t, std::vector<double>> scenes_of_seed;
  for (const Record* record : records)
    if (const auto it = record->metrics.find(column.metric);
        record->ok() && it != record->metrics.end()) {
      const double value = it->second * column.scale;
      scenes_of_seed[record->cell.seed].push_back(value);
      cell.values[{record->cell.scene, record->cell.seed}] = value;
    }
  if (scenes_of_seed.empty()) return cell_without_values(records, column);

  std::vector<double> seed_means;
  std::size_t fewest = expected;
  for (const auto& [seed, values] : scenes_of_seed) {
    seed_means.push_back(mean_of(values));
    fewest = std::min(fewest, values.size());
  }
  cell.value = mean_of(seed_means);
  cell.spread = spread_of(seed_means);
  cell.num_scenes = static_cast<int>(fewest);
  cell.num_seeds = static_cast<int>(seed_means.size());
  cell.text = format_value(cell.value, column);
  cell.status = fewest == expected ? CellStatus::kOk : CellStatus::kPartial;
  if (cell.status == CellStatus::kPartial)
    cell.note = fmt::format("mean over {} of {} scenes", fewest, expected);
  return cell;
}

std::string text_field(const Record& record, const std::string& field) {
  if (field == "resolution") return record.resolution;
  const auto it = record.environment.find(field);
  return it != record.environment.end() && it->is_string() ? it->get<std::string>() : "";
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

TableRow build_row(
    const TableDefinition& definition,
    const TableRowDefinition& row,
    const std::vector<TableColumn>& columns,
    const std::vector<Record>& records
) {
  TableRow result{row.method, row.title, row.paper_row, {}};
  for (const TableColumn& column : columns) {
    if (column.published) {
      result.cells.push_back(published_cell(definition, column, row));
      continue;
    }
    RecordPointers matching;
    for (const Record& record : records)
      if (record.dataset == column.dataset && record.cell.method == row.method)
        matching.push_back(&record);
    result.cells.push_back(
        column.metric.empty()
            ? text_cell(matching, column)
            : measured_cell(matching, column, scenes_of(records, column.dataset).size())
    );
  }
  return result;
}

// 1 for the best; equal values share a rank and the next one is skipped. Methods beyond the paper's
// rows (controls, variants) are ranked too: they are results like any other.
void rank_column(Table& table, std::size_t column) {
  const RankOrder order = table.columns[column].order;
  std::vector<double> values;
  for (const TableRow& row : table.rows)
    if (row.cells[column].status == CellStatus::kOk) values.push_back(row.cells[column].value);
  if (order == RankOrder::kNone || values.size() < 2) return;
  for (TableRow& row : table.rows) {
    TableCell& cell = row.cells[column];
    if (cell.status != CellStatus::kOk) continue;
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

// Of the scenes and seeds that both cells have.
std::vector<double> paired_differences(const TableCell& a, const TableCell& b) {
  std::vector<double> differences;
  for (const auto& [key, value] : a.values)
    if (const auto it = b.values.find(key); it != b.values.end())
      differences.push_back(value - it->second);
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
  const std::string published_id =
      fmt::format("published/{}/{}", paper_dataset, table.columns[measured].paper_column);
  const auto it =
      std::find_if(table.columns.begin(), table.columns.end(), [&](const TableColumn& column) {
        return column.id == published_id;
      });
  if (it == table.columns.end()) return;
  const auto published = static_cast<std::size_t>(it - table.columns.begin());
  std::vector<ComparedMethod> methods;
  for (const TableRow& row : table.rows)
    if (row.cells[measured].status == CellStatus::kOk &&
        row.cells[published].status == CellStatus::kOk)
      methods.push_back(
          {row.cells[measured].value, row.cells[published].value, row.cells[measured].values}
      );
  std::optional<OrderAgreement> agreement = order_agreement(methods);
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

// What the methods of the rows have to say, each line once.
void add_method_notes(Table& table, const std::vector<Record>& records) {
  std::set<std::string> notes;
  for (const TableRow& row : table.rows)
    for (const Record& record : records)
      if (record.cell.method == row.method)
        for (const std::string& note : record.notes)
          notes.insert(fmt::format("{}: {}.", row.title, note));
  table.notes.insert(table.notes.end(), notes.begin(), notes.end());
}

void add_notes(
    Table& table, const TableDefinition& definition, const std::vector<Record>& records
) {
  std::set<std::uint64_t> seeds;
  for (const Record& record : records) seeds.insert(record.cell.seed);
  std::string scenes;
  for (const std::string& scene : scenes_of(records, definition.dataset))
    scenes += (scenes.empty() ? "" : ", ") + scene;
  table.notes.push_back(fmt::format(
      "Mean over test views, then {} ({}), then {}.{}",
      counted(scenes_of(records, definition.dataset).size(), "scene"),
      scenes.empty() ? "none run yet" : scenes,
      counted(seeds.size(), "seed"),
      seeds.size() > 1 ? " ±: standard deviation over seeds, of two their range." : ""
  ));
  std::set<std::string> failures;
  for (const Record& record : records)
    for (const TableRow& row : table.rows)
      if (!record.ok() && record.cell.method == row.method) failures.insert(failure_note(record));
  table.notes.insert(table.notes.end(), failures.begin(), failures.end());
  add_method_notes(table, records);
  for (const OrderAgreement& order : table.agreement) table.notes.push_back(agreement_note(order));
}

}  // namespace

Table build_table(const TableDefinition& definition, const std::vector<Record>& records) {
  Table table{definition.id, definition.title, definition.caption, {}, {}, {}, {}};
  table.columns = columns_of(definition, records);
  for (const TableRowDefinition& row : rows_of(definition, records))
    table.rows.push_back(build_row(definition, row, table.columns, records));
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
  return table;
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
