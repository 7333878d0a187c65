// SPDX-License-Identifier: MIT
#include "reports/show/tables/order_by_length.h"

#include <algorithm>
#include <set>

#include "glint/core/presence.h"
#include "reports/show/tables/results_page.h"
#include "reports/show/tables/table_writers.h"
#include "reports/show/tables/training_notes.h"

namespace glint {
namespace {

constexpr const char* kTables[] = {"table1_photometric", "table2_geometry"};
constexpr const char* kLengths = "docs/results/lengths.json";

// The paper's methods and the columns that have published counterparts.
TableDefinition compared_definition(const std::string& id) {
  TableDefinition definition = table_definition(id);
  std::erase_if(definition.columns, [](const TableColumn& column) {
    return column.paper_column.empty();
  });
  return definition;
}

// Of scenes as of whole tables: what few photos say is not what many do.
enum class Photos { kUnknown, kFew, kMany };

Photos class_of(int photos) {
  if (photos <= 0) return Photos::kUnknown;
  return photos < kFewPhotos ? Photos::kFew : Photos::kMany;
}

// Records of the table's methods in one file at one size, of scenes with few photos or with many,
// by method and steps.
struct Lengths {
  std::string file, resolution;
  int photos = 0, most_photos = 0;  // of the scenes with fewest and with most
  std::map<std::string, std::map<int, std::vector<Record>>> methods;

  std::set<int> steps() const {
    std::set<int> all;
    for (const auto& [method, by_steps] : methods)
      for (const auto& [steps, records] : by_steps) all.insert(steps);
    return all;
  }
};

// By size and photos. Records whose steps nobody knows, and failed ones, are left out.
std::vector<Lengths> lengths_of(const RecordsOfFile& file, const TableDefinition& definition) {
  std::map<std::pair<std::string, Photos>, Lengths> by_size;
  std::set<std::string> compared;
  for (const TableRowDefinition& row : definition.rows) compared.insert(row.method);
  for (const Record& record : file.records) {
    const int steps = record.iterations > 0 ? record.iterations : file.steps;
    if (!record.ok() || steps <= 0 || record.dataset != definition.dataset ||
        !compared.contains(record.cell.method))
      continue;
    const int photos = record.training_views > 0 ? record.training_views : file.photos;
    Lengths& lengths = by_size[{record.resolution, class_of(photos)}];
    lengths.file = file.file;
    lengths.resolution = record.resolution;
    lengths.photos = lengths.methods.empty() ? photos : std::min(lengths.photos, photos);
    lengths.most_photos = std::max(lengths.most_photos, photos);
    lengths.methods[record.cell.method][steps].push_back(record);
  }
  std::vector<Lengths> all;
  for (auto& [size, lengths] : by_size) all.push_back(std::move(lengths));
  return all;
}

// What a file has of one length.
struct Candidate {
  int steps = 0;
  std::vector<Record> records;
  std::vector<std::string> missing, longer;  // titles
};

Candidate candidate_of(const Lengths& lengths, int steps, const TableDefinition& definition) {
  Candidate candidate{steps, {}, {}, {}};
  for (const TableRowDefinition& row : definition.rows) {
    const auto method = lengths.methods.find(row.method);
    const auto found =
        method == lengths.methods.end() ? std::map<int, std::vector<Record>>() : method->second;
    const auto at = found.lower_bound(steps);
    if (at == found.end()) {
      candidate.missing.push_back(row.title);
      continue;
    }
    if (at->first > steps)
      candidate.longer.push_back(fmt::format("{} {} steps", row.title, at->first));
    candidate.records.insert(candidate.records.end(), at->second.begin(), at->second.end());
  }
  return candidate;
}

// Is the length one of its own, and not that of the few that were trained longer?
bool is_own_length(const Lengths& lengths, int steps) {
  const auto methods =
      std::count_if(lengths.methods.begin(), lengths.methods.end(), [&](const auto& method) {
        return method.second.contains(steps);
      });
  return 2 * methods > static_cast<std::ptrdiff_t>(lengths.methods.size());
}

using Compared = std::map<std::string, std::vector<ComparedMethod>>;  // by column

// Columns in which every method of the paper has a value that can be ranked.
Compared compared_columns(const Table& table, const TableDefinition& definition) {
  Compared columns;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].published || table.columns[i].dataset != definition.dataset) continue;
    auto methods = compared_methods(table, i, definition.paper_datasets.front());
    if (methods.size() == definition.rows.size()) columns[table.columns[i].id] = std::move(methods);
  }
  return columns;
}

struct MeasuredPoint {
  OrderPoint point;
  Compared columns;
};

MeasuredPoint measured_point(
    const Lengths& lengths, const Candidate& candidate, const TableDefinition& definition
) {
  const Table table = build_table(definition, candidate.records);
  MeasuredPoint measured;
  OrderPoint& point = measured.point;
  point.steps = candidate.steps;
  point.table = definition.id;
  point.title = definition.title;
  point.records = lengths.file;
  point.resolution = lengths.resolution;
  point.photos = lengths.photos;
  point.most_photos = lengths.most_photos;
  point.longer = candidate.longer;
  for (const TableColumn& column : definition.columns) point.titles[column.id] = column.title;
  for (const TableCell& cell : table.rows.front().cells) {
    point.num_scenes = std::max(point.num_scenes, cell.num_scenes);
    point.num_seeds = std::max(point.num_seeds, cell.num_seeds);
  }
  measured.columns = compared_columns(table, definition);
  return measured;
}

std::string length_text(int steps, const Lengths& lengths) {
  return fmt::format("{} steps at {} ({})", steps, lengths.resolution, lengths.file);
}

// All points of a table, and what is left out.
class PointsOfTable {
 public:
  explicit PointsOfTable(const std::string& id) : definition_(compared_definition(id)) {}

  void add(const RecordsOfFile& file) {
    for (const Lengths& lengths : lengths_of(file, definition_))
      for (const int steps : lengths.steps())
        if (is_own_length(lengths, steps)) add_length(lengths, steps);
  }

  void give(OrderByLength& order) {
    const std::set<std::string> shared = shared_columns();
    for (auto& [place, measured] : points_) {
      fill(measured, shared);
      if (!measured.point.columns.empty()) order.points.push_back(std::move(measured.point));
    }
    for (const std::string& why : left_out_)
      if (std::find(order.left_out.begin(), order.left_out.end(), why) == order.left_out.end())
        order.left_out.push_back(why);
  }

 private:
  void add_length(const Lengths& lengths, int steps) {
    const Candidate candidate = candidate_of(lengths, steps, definition_);
    const std::string text = length_text(steps, lengths);
    if (!candidate.missing.empty()) {
      left_out_.push_back(fmt::format("{}: lacks {}", text, fmt::join(candidate.missing, ", ")));
      return;
    }
    MeasuredPoint measured = measured_point(lengths, candidate, definition_);
    if (measured.columns.empty()) return;  // of another table alone
    const auto pairs = [](const OrderPoint& point) { return point.num_scenes * point.num_seeds; };
    const auto [it, is_new] = points_.try_emplace({class_of(lengths.photos), steps}, measured);
    if (is_new) return;
    if (pairs(measured.point) > pairs(it->second.point)) std::swap(it->second, measured);
    const bool is_tied = pairs(measured.point) == pairs(it->second.point);
    left_out_.push_back(fmt::format(
        "{} steps at {} ({}): {} {}",
        steps,
        measured.point.resolution,
        measured.point.records,
        it->second.point.records,
        is_tied ? "has as many rooms and seeds, and stands first" : "has more rooms and seeds"
    ));
  }

  // So that points of one table are means of the same columns.
  std::set<std::string> shared_columns() const {
    std::set<std::string> shared;
    for (const TableColumn& column : definition_.columns)
      if (!points_.empty() && std::all_of(points_.begin(), points_.end(), [&](const auto& point) {
            return point.second.columns.contains(column.id);
          }))
        shared.insert(column.id);
    return shared;
  }

  void fill(MeasuredPoint& measured, const std::set<std::string>& shared) const {
    std::vector<std::vector<ComparedMethod>> columns;
    for (const TableColumn& column : definition_.columns) {
      if (!shared.contains(column.id)) continue;
      const auto& methods = measured.columns.at(column.id);
      std::optional<OrderAgreement> one = order_agreement(methods);
      if (!one) continue;
      one->column = column.id;
      measured.point.columns.push_back(*one);
      columns.push_back(methods);
    }
    if (const auto mean = mean_order_agreement(columns)) measured.point.mean = *mean;
  }

  TableDefinition definition_;
  std::map<std::pair<Photos, int>, MeasuredPoint> points_;  // by photos, then by steps
  std::vector<std::string> left_out_;
};

RecordsOfFile read_file_of(const fs::path& root, RecordsOfFile file) {
  GLINT_CHECK(
      is_file(root / file.file),
      kBadReference,
      "{}: no such file, which {} names",
      file.file,
      kLengths
  );
  file.records = read_records(root / file.file);
  return file;
}

// What lengths.json says of a file's records.
RecordsOfFile entry_of(const Json& entry) {
  const Json file = entry.is_object() ? entry.value("records", Json()) : Json();
  GLINT_CHECK(file.is_string(), kBadReference, "{}: an entry without 'records'", kLengths);
  RecordsOfFile one{file.get<std::string>(), 0, {}};
  one.steps = static_cast<int>(number_or(entry, "steps", 0));
  one.photos = static_cast<int>(number_or(entry, "photos", 0));
  return one;
}

std::vector<RecordsOfFile> files_of(const fs::path& root) {
  std::map<std::string, RecordsOfFile> named;
  for (const fs::path& part : results_parts(root)) {
    const std::string file = read_results_info(part).records;
    named[file].file = file;
  }
  if (is_file(root / kLengths)) {
    const Json lengths = parse_json(read_file(root / kLengths));
    GLINT_CHECK(lengths.is_array(), kBadReference, "{}: expected a JSON list", kLengths);
    for (const Json& entry : lengths) {
      RecordsOfFile one = entry_of(entry);
      named[one.file] = one;
    }
  }
  std::vector<RecordsOfFile> files;
  for (const auto& [name, file] : named) files.push_back(read_file_of(root, file));
  return files;
}

std::string interval_of(const OrderAgreement& order) {
  if (!order.interval) return fmt::format("{:.2f}", order.tau);
  return fmt::format(
      "{:.2f} [{:.2f}, {:.2f}]", order.tau, order.interval->low, order.interval->high
  );
}

std::string point_row(const OrderPoint& point) {
  return fmt::format(
      "| {} | {} | {} | {} | ±{:.2f} | {} | `{}` |\n",
      point.steps,
      point.measured_on(),
      markdown_text(point.title),
      interval_of(point.mean),
      point.mean.chance.high,
      markdown_text(point.columns_text()),
      point.records
  );
}

}  // namespace

std::string OrderPoint::measured_on() const {
  const auto counted = [](int count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
  };
  std::string text = fmt::format("{}, {}", counted(num_scenes, "room"), counted(num_seeds, "seed"));
  if (most_photos > photos)
    text += fmt::format(", {} to {} photos", photos, most_photos);
  else if (photos > 0)
    text += fmt::format(", {}", counted(photos, "photo"));
  return text;
}

std::string OrderPoint::columns_text() const {
  std::vector<std::string> texts;
  for (const OrderAgreement& one : columns)
    texts.push_back(fmt::format("{} {:.2f}", titles.at(one.column), one.tau));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string OrderPoint::series() const {
  switch (class_of(photos)) {
    case Photos::kUnknown:
      return title;
    case Photos::kFew:
      return title + ", few photos";
    case Photos::kMany:
      return title + ", many photos";
  }
  return title;
}

OrderByLength order_by_length(const std::vector<RecordsOfFile>& files) {
  OrderByLength order;
  for (const char* id : kTables) {
    PointsOfTable points(id);
    for (const RecordsOfFile& file : files) points.add(file);
    points.give(order);
  }
  return order;
}

OrderByLength order_by_length(const fs::path& root) { return order_by_length(files_of(root)); }

std::vector<std::string> order_notes(const OrderByLength& order) {
  std::vector<std::string> notes{
      "Kendall's tau of the order of the paper's six methods, measured against published on "
      "3D-FRONT-T: 1 the same order, -1 the reverse. Of a table: the mean over its columns.",
      "[low, high]: 95 % by bootstrap over rooms and seeds, too narrow where they are few. Chance: "
      "95 % of random orders lie within.",
      fmt::format("Photos: of a scene, for training; few are less than {}.", kFewPhotos)};
  for (const OrderPoint& point : order.points)
    for (const std::string& longer : point.longer)
      if (const std::string note = fmt::format("At {} steps: {}.", point.steps, longer);
          std::find(notes.begin(), notes.end(), note) == notes.end())
        notes.push_back(note);
  for (const std::string& why : order.left_out) notes.push_back("Left out: " + why + ".");
  return notes;
}

std::string order_markdown(const OrderByLength& order) {
  std::string text = fmt::format(
      "# {}\n\n![Kendall's tau by steps]({})\n\n",
      kOrderTitle,
      fs::path(kOrderFigure).filename().string()
  );
  text += "| Steps | Measured on | Table | Mean tau | Chance | Tau of columns | Records |\n";
  text += "| ---: | --- | --- | ---: | ---: | --- | --- |\n";
  for (const OrderPoint& point : order.points) text += point_row(point);
  text += "\n";
  for (const std::string& note : order_notes(order))
    text += fmt::format("- {}\n", markdown_text(note));
  return text;
}

}  // namespace glint
