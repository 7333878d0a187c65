// SPDX-License-Identifier: MIT
#include "reports/run/records/records.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

#include "glint/core/json_error.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/scene.h"

namespace glint {

namespace {

// The same field written and read in one place. `v(name, field)` is called for every plain field.
template <class R, class V>
void visit_fields(R& record, V&& v) {
  v("schema", record.schema);
  v("profile", record.profile);
  v("dataset", record.dataset);
  v("scene", record.cell.scene);
  v("method", record.cell.method);
  v("seed", record.cell.seed);
  v("resolution", record.resolution);
  v("imported", record.imported);
  v("train_key", record.train_key);
  v("score_key", record.score_key);
  v("dataset_hash", record.dataset_hash);
  v("iterations", record.iterations);
  v("training_views", record.training_views);
  v("num_surfels", record.num_surfels);
  v("estimated_memory_mb", record.estimated_memory_mb);
  v("process_memory_mb", record.process_memory_mb);
  v("warnings", record.warnings);
  v("notes", record.notes);
  v("data_notes", record.data_notes);
  v("not_measured", record.not_measured);
  v("not_applicable", record.not_applicable);
  v("void_steps", record.void_steps);
  v("timings", record.timings);
  v("environment", record.environment);
}

template <class F, class V>
void visit_failure(F& failure, V&& v) {
  v("stage", failure.stage);
  v("kind", failure.kind);
  v("message", failure.message);
  v("log_tail", failure.log_tail);
  v("iteration", failure.iteration);
  v("attempts", failure.attempts);
  v("output_tail", failure.output_tail);
}

auto reader_of(const Json& json) {
  return [&json](const char* name, auto& field) {
    if (const auto it = json.find(name); it != json.end()) read_field(*it, field);
  };
}

auto writer_to(Json& json) {
  return [&json](const char* name, const auto& field) { json[name] = field; };
}

Record fields_of(const Json& json) {
  Record record;
  visit_fields(record, reader_of(json));
  if (json.value("status", "ok") == "failed") {
    record.failure.emplace();
    const Json failure = json.value("failure", Json::object());
    visit_failure(*record.failure, reader_of(failure));
  }
  const Json seconds = std::exchange(record.timings, Json::object());
  for (const auto& [stage, value] : seconds.items())
    if (value.is_number()) record.timings[stage] = value;
  if (!record.environment.is_object()) record.environment = Json::object();
  if (const Json made = json.value("meshes_made", Json()); made.is_object())
    record.meshes_made = made;
  const Json metrics = json.value("metrics", Json::object());
  for (const auto& [id, value] : metrics.items())
    if (value.is_number()) record.metrics[id] = value.get<double>();
  return record;
}

// Files of results and figures have these names, with parts as "glint/no-trans".
void check_names(const CellKey& cell, std::string_view where) {
  const auto check = [&](const char* field, const std::string& name) {
    std::istringstream parts(name + "/");
    for (std::string part; std::getline(parts, part, '/');) {
      const std::string why = why_no_folder_name(part);
      GLINT_CHECK(
          why.empty(), kBadPrediction, "{}: {} '{}': '{}' {}", where, field, name, part, why
      );
    }
  };
  check("scene", cell.scene);
  check("method", cell.method);
}

std::string end_of_file(const fs::path& file, std::uintmax_t from_byte) {
  if (from_byte == 0) return read_file(file);
  std::ifstream in = open_file(file);
  in.seekg(static_cast<std::streamoff>(from_byte));
  return {std::istreambuf_iterator<char>(in), {}};
}

// The last record of a cell wins and keeps the cell's place.
class RecordList {
 public:
  void add(Record record) {
    const auto [it, added] = places_.emplace(record.cell, records_.size());
    if (added)
      records_.push_back(std::move(record));
    else
      records_[it->second] = std::move(record);
  }
  std::vector<Record> take() { return std::move(records_); }

 private:
  std::vector<Record> records_;
  std::map<CellKey, std::size_t> places_;
};

}  // namespace

std::string CellKey::text() const { return fmt::format("{}/{}/{}", scene, method, seed); }

Json record_to_json(const Record& record) {
  Json json = Json::object();
  visit_fields(record, writer_to(json));
  if (!record.meshes_made.is_null()) json["meshes_made"] = record.meshes_made;
  json["status"] = record.ok() ? "ok" : "failed";
  if (!record.ok()) visit_failure(*record.failure, writer_to(json["failure"] = Json::object()));
  json["metrics"] = Json::object();
  for (const auto& [id, value] : record.metrics)
    if (std::isfinite(value)) json["metrics"][id] = value;
  return json;
}

Record record_from_json(const Json& json, std::string_view where) {
  GLINT_CHECK(
      json.is_object() && json.contains("scene") && json.contains("method"),
      kBadPrediction,
      "{}: not a record (no 'scene' or 'method')",
      where
  );
  try {
    Record record = fields_of(json);
    check_names(record.cell, where);
    GLINT_CHECK(
        record.schema <= kRecordSchema,
        kBadPrediction,
        "{}: schema {} is newer than this program's {}; update the program",
        where,
        record.schema,
        kRecordSchema
    );
    return record;
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        ExitCode::kBadPrediction,
        fmt::format("{}: a field has another type ({})", where, json_error(error))
    );
  }
}

void append_record(const fs::path& file, const Record& record) {
  append_line(file, record_to_json(record).dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::vector<Record> read_every_record(const fs::path& file, std::uintmax_t from_byte) {
  std::vector<Record> records;
  std::istringstream lines(with_exit_code(ExitCode::kBadPrediction, [&] {
    return is_there(file) ? end_of_file(file, from_byte) : "";
  }));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string where = fmt::format("{}:{}", file.string(), ++number);
    if (line.empty()) continue;
    const Json json = parse_json(line);
    if (json.is_discarded())
      log::warn(where + ": torn record (interrupted write) or nested too deeply, skipped");
    else
      records.push_back(record_from_json(json, where));
  }
  return records;
}

std::vector<Record> read_records(const fs::path& file, std::uintmax_t from_byte) {
  RecordList records;
  for (Record& record : read_every_record(file, from_byte)) records.add(std::move(record));
  return records.take();
}

bool is_cost(const std::string& metric) {
  static const std::set<std::string> costs{"fps", "train-minutes", "peak-memory", "device-memory"};
  return costs.contains(metric);
}

const Record* find_record(const std::vector<Record>& records, const CellKey& cell) {
  const auto it = std::find_if(records.begin(), records.end(), [&](const Record& record) {
    return record.cell == cell;
  });
  return it == records.end() ? nullptr : &*it;
}

}  // namespace glint
