// SPDX-License-Identifier: MIT
// What a run is and what is recorded of it, made in one place for cells of a profile, single runs,
// models and renders of other programs.
#pragma once

#include "reports/run/bench/plan.h"
#include "reports/run/bench/stages.h"
#include "reports/run/records/run_folder.h"

namespace glint {

// The run of a cell on its data. What is of the command (checkpoints, --force) is as by default.
RunSpec make_spec(
    const PlanCell& cell, const Profile& profile, const LoadedScene& loaded, const fs::path& run
);

// Of a cell of the profile, before anything is known of it.
Record new_record(const std::string& profile, const std::string& dataset, const CellKey& cell);

// Of a run that was scored, by what its folder says: keys, what was not measured and why (files of
// metrics, no mesh, no env.json), what does not apply, surfels, the training's time and words, the
// size of the test views. Errors: training_cost()'s.
Record make_record(
    const std::string& profile, const RunSpec& spec, const Scene& scene, const Scores& means
);

// What training took, as metrics: "train-minutes", "peak-memory" and, of a GPU, "device-memory"
// (MB). Empty: nobody knows (no env.json), or another program trained it. Errors (kBadPrediction):
// env.json is damaged.
Scores training_cost(const RunSpec& spec);

// Metrics of meshes that have neither a value nor a reason in the record, because the data have no
// true mesh of the layer.
std::vector<std::string> meshes_without_truth(const Record& record, const RunSpec& spec);

}  // namespace glint
