// SPDX-License-Identifier: MIT
// runs/<scene>/<method>/<seed>/: everything about one cell. Stages read and write here, so each can
// be repeated alone and every number of a table can be traced to files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "glint/method.h"
#include "reports/run/records/records.h"
#include "reports/run/records/scene_source.h"

namespace glint {

// What one run is; config.json holds it.
struct RunSpec {
  fs::path folder;
  std::string method;
  std::string row;  // in tables; empty: the method's (models of other programs have one)
  Json config = Json::object();  // overrides for MethodSpec::create
  RunOptions options;
  fs::path dataset_folder;
  std::string dataset, scene;              // names
  double max_pixels = 0, image_ratio = 1;  // how pictures are shrunk (LoadOptions)
  std::string dataset_hash;                // as the loader knows the data
  // Not in config.json:
  Json train_document;              // what the training goes by (stage_documents.h)
  double checkpoint_seconds = 300;  // between checkpoints, at least
  int test_psnr_every = 0;          // TrainOptions
  bool anew = false;                // an unfinished training does not go on

  CellKey cell() const { return {scene, row.empty() ? method : row, options.seed}; }
};

fs::path run_folder(const fs::path& out, const CellKey& cell);

void write_run_spec(const RunSpec& spec, const Json& resolved_config);
// Errors (kBadPrediction): no run folder, config.json damaged.
RunSpec read_run_spec(const fs::path& folder);

// What training cost and had to say, in env.json; nothing: no training has ended there.
struct TrainCost {
  double seconds = 0, peak_memory_mb = 0;
  double device_memory_mb = 0;  // 0: trained on the CPU, or by an earlier version
  std::vector<std::string> warnings, notes, data_notes;  // of the method; of the scene
  Json void_steps;  // "count" and "last" (VoidSteps); null: of an earlier version, or not trained
};
void write_trained(const RunSpec& spec, const TrainCost& cost);
std::optional<TrainCost> trained_cost(const RunSpec& spec);

// renders/<flat name>.
fs::path view_folder(const fs::path& run, const std::string& view_name);

// Every map under its names in the table (glint/scene/maps.h): values as EXR, pictures for people
// as PNG. Errors (kBadPrediction): a map of another size than rgb, of other channels than the table
// says, or without a file there. `eight_bit`: the image came in integers, so it is a PNG only and
// no EXR pretends to hold more.
void write_render(const fs::path& folder, const MapSet& rendered, bool eight_bit = false);

// In config.json of imported runs: did their images come in integers?
inline constexpr const char* kEightBitField = "eight_bit";
// Of a view's folder: is the image a PNG only, as the run says?
bool is_eight_bit_render(const fs::path& view_folder);

// Where a map of a render lies: its values, or the picture where there is nothing but that.
fs::path render_file(const fs::path& folder, const MapRow& row);

// Last lines of log.jsonl, for failure records.
std::vector<std::string> log_tail(const fs::path& run, std::size_t lines = 50);

}  // namespace glint
