// SPDX-License-Identifier: MIT
// What a run folder says of its run for the record, beside the scores: for cells of a profile and
// for single runs.
#pragma once

#include "reports/bench/evaluate.h"
#include "reports/records/run_folder.h"

namespace glint {

// What training took, as metrics: "train-minutes", "peak-memory" and, of a GPU, "device-memory"
// (MB). Empty: nobody knows (no env.json), or another program trained it. Errors (kBadPrediction):
// env.json is damaged.
Scores training_cost(const RunSpec& spec);

// Fills in a record that has its metrics: what else was not measured and why (files of metrics, no
// mesh, no env.json), what does not apply, surfels, the training's time and words, the size of the
// test views. Errors: training_cost()'s.
void describe_run(Record& record, const RunSpec& spec, const Scene& scene);

// Metrics of meshes that have neither a value nor a reason in the record, because the data have no
// true mesh of the layer.
std::vector<std::string> meshes_without_truth(const Record& record, const RunSpec& spec);

}  // namespace glint
