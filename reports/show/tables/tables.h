// SPDX-License-Identifier: MIT
// Tables of results: a definition (reports/tables/*.toml: rows, columns; one file a table) and the
// records of a profile give one Table, which the writers in table_writers.h print in each format.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "glint/core/config.h"
#include "reports/run/records/records.h"
#include "reports/show/tables/agreement.h"
#include "reports/show/tables/statistics.h"

namespace glint {

enum class RankOrder { kHigherFirst, kLowerFirst, kNone };

struct TableColumn {
  std::string id;            // "psnr", "published/3D-FRONT-T/PSNR"; unique in the table
  std::string title;         // "PSNR"
  std::string group;         // what stands above: "GlassRoom", "3D-FRONT-T"
  std::string metric;        // id in Record::metrics; empty in text and published columns
  std::string field;         // text columns: "device" or "resolution"
  std::string dataset;       // records that count
  std::string paper_column;  // of the published counterpart; empty: the paper has none
  std::string paper_title;   // what that one is called; empty: the same title
  std::string unit;
  RankOrder order = RankOrder::kNone;
  int decimals = 2;
  double scale = 1;             // shown = scale x measured
  bool where_measured = false;  // no column where no record has it
  bool published = false;       // the paper's numbers on the paper's own data
};

struct TableRowDefinition {
  std::string method;     // id of the method
  std::string title;      // as printed
  std::string paper_row;  // row in the paper's table; empty: not in the paper
};

struct TableDefinition {
  std::string id, title, caption;
  std::string dataset, dataset_title;       // "glassroom", "GlassRoom"
  std::string paper_table;                  // "1"; empty: the paper has no such table
  std::vector<std::string> paper_datasets;  // published columns, one group each
  bool where_measured = false;  // shown where a record has one of its columns, or asked for
  // Globs of methods without a row although they have records: those that stand in other tables.
  std::vector<std::string> leave_out;
  std::vector<TableRowDefinition> rows;
  std::vector<TableColumn> columns;
};

enum class CellStatus {
  kOk,
  kPartial,        // of fewer or other scenes than others, or of 8-bit images; never ranked
  kMissing,        // not built or not run
  kFailed,         // every run failed
  kUnavailable,    // run where the metric's files were missing; `text` says which
  kNotApplicable,  // the paper has no such number, the method no such map, or the data no truth
};

struct TableCell {
  CellStatus status = CellStatus::kMissing;
  double value = 0;   // in the column's unit, unrounded
  double spread = 0;  // over seeds: sample standard deviation (>= 3 seeds) or range (2)
  std::optional<Interval> interval;  // of the mean, by bootstrap over scenes and seeds
  int num_scenes = 0, num_seeds = 0;
  std::map<std::pair<std::string, std::uint64_t>, double> values;  // of each scene and seed
  int rank = 0;        // 1, 2, 3; 0: not among them or nothing to rank against
  bool apart = false;  // on none of the scenes, or at another size, of the other methods' means
  bool tied = false;   // second, but the interval of the difference to the first contains zero
  std::string text;    // as printed, without marks
  std::string note;    // why it failed, or what is missing

  bool has_value() const { return status == CellStatus::kOk || status == CellStatus::kPartial; }
};

struct TableRow {
  std::string method, title;
  std::vector<TableCell> cells;  // one a column
  bool rival = true;  // false: was given the truth (MethodSpec); never ranked, stands last
};

// Opens the note that says what the intervals are.
inline constexpr std::string_view kIntervalNote = "[low, high]:";

struct Table {
  std::string id, title, caption;
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
  std::vector<OrderAgreement> agreement;
  std::vector<std::string> notes;  // scenes and seeds, failures, what the marks mean
};

// The shades of first, second and third in the paper's tables, RGB 0..255.
inline constexpr int kRankShades[3][3] = {{200, 225, 255}, {225, 240, 255}, {242, 248, 255}};

// Errors (kUsage): not a table definition; `where` opens the message.
TableDefinition parse_table_definition(std::string_view toml, const std::string& id);
// All embedded definitions, in the order of their ids.
std::vector<TableDefinition> table_definitions();
// One of them by its id. Errors (kUsage): there is none.
TableDefinition table_definition(const std::string& id);

// Means over views are in the records; here over the scenes that most methods have at one size
// (common_scenes.h), then over seeds. Ranks on unrounded values. Every method with records has a
// row, unless the definition leaves it out; rows of other scenes or sizes come last, and behind
// them those that are no rivals, which have no say in scenes and ranks.
Table build_table(const TableDefinition& definition, const std::vector<Record>& records);

// Of the methods of a column that can be ranked and that the paper has numbers of, both: against
// its dataset `paper_dataset`. Empty: the paper has no such column.
std::vector<ComparedMethod> compared_methods(
    const Table& table, std::size_t measured, const std::string& paper_dataset
);

// For tables of a choice: no row for a method that has no record among the chosen.
void keep_rows_with_records(TableDefinition& definition, const std::vector<Record>& records);

// Has it a number that this suite measured, complete or partial?
bool has_measurement(const Table& table);

std::string_view order_arrow(RankOrder order);  // "↑", "↓", ""

}  // namespace glint
