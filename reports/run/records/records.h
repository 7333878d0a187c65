// SPDX-License-Identifier: MIT
// records.jsonl: what a profile's folder knows about its cells. One JSON object a line, appended
// when a cell ends, whether it finished or failed; never rewritten. docs/reference/records.md lists
// the fields.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/files.h"

namespace glint {

inline constexpr int kRecordSchema = 2;

// One entry of scene x method x seed.
struct CellKey {
  std::string scene, method;
  std::uint64_t seed = 0;
  std::string text() const;  // "room_1/glint/no-trans/0"
  friend auto operator<=>(const CellKey&, const CellKey&) = default;
};

struct Failure {
  std::string stage;  // of stage_name(): "data", "train", "render", "mesh", "score"
  std::string kind;   // of failure_kinds(): "not-finite", "crash", ...
  std::string message;
  std::vector<std::string> log_tail;          // last lines of log.jsonl
  int iteration = -1;                         // that the training had reached; -1: none is known
  int attempts = 1;                           // that failed one after the other
  std::vector<std::string> output_tail = {};  // last lines that its process wrote, if it crashed
};

struct Record {
  int schema = kRecordSchema;
  std::string profile, dataset;
  CellKey cell;
  std::optional<Failure> failure;         // set: the cell failed, `metrics` is empty
  std::map<std::string, double> metrics;  // id -> mean over test views; "psnr@glass" for a region
  std::map<std::string, std::string> not_measured;  // id -> what the machine lacked: "no weights"
  std::vector<std::string> not_applicable;  // ids that neither the method nor the data allow
  std::string resolution;                   // of the test views, "160x90"
  std::string imported;  // where another program's renders lay; empty: trained here
  // What trained it and what scored it (stage_files.h); records of schema 1 have none.
  std::string train_key, score_key;
  std::string dataset_hash;  // as the loader knows the data
  int iterations = 0;        // of its training; 0: unknown, or trained elsewhere
  int training_views = 0;    // photos it was trained on; 0: unknown, or trained elsewhere
  std::size_t num_surfels = 0;
  double estimated_memory_mb = 0;     // before its training
  double process_memory_mb = 0;       // the most that its process took; metrics have the training's
  std::vector<std::string> warnings;  // of the method: losses off, missing priors
  std::vector<std::string> notes;     // of the method, for readers of tables: which masks it got
  std::vector<std::string> data_notes;  // of the scene it was trained on: how priors were read
  Json void_steps;                      // of its training (run_folder.h); null: not known
  Json meshes_made;                     // where meshes of a parcel were made; null: with the rest
  Json timings = Json::object();        // stage -> seconds
  Json environment = Json::object();    // machine, build, date

  bool ok() const { return !failure.has_value(); }
};

Json record_to_json(const Record& record);
// Unknown fields are ignored and absent ones keep their defaults, so older and newer files read.
// Errors (kBadPrediction): `json` is no record (no cell, wrong types).
Record record_from_json(const Json& json, std::string_view where);

void append_record(const fs::path& file, const Record& record);

// All cells of a file, the last record of each winning, in the order of the first appearance. Lines
// torn by a crash while appending are reported and skipped; no file means no records.
// `from_byte`: only what was appended since the file had that size. Errors (kBadPrediction): a line
// that is JSON but no record, a newer schema.
std::vector<Record> read_records(const fs::path& file, std::uintmax_t from_byte = 0);

// The same with every line, also those that later ones of their cell replace: what a store has been
// told so far. Errors: as above.
std::vector<Record> read_every_record(const fs::path& file, std::uintmax_t from_byte = 0);

// Is this metric the machine's, not the method's: speed, time, memory?
bool is_cost(const std::string& metric);

const Record* find_record(const std::vector<Record>& records, const CellKey& cell);

}  // namespace glint
