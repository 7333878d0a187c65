// SPDX-License-Identifier: MIT
// What tables say of how their rows were trained: for how many steps, on how many photos. A table
// of short runs, or of scenes with few photos, can have another order than the paper's.
#pragma once

#include <vector>

#include "reports/run/records/records.h"
#include "reports/show/tables/tables.h"

namespace glint {

// Fewer photos for training, a scene, are few. A scene of 3D-FRONT-T has 156 (779 of five).
inline constexpr int kFewPhotos = 100;

// Title and caption of short runs: a smoke test.
void warn_of_short_runs(Table& table, const std::vector<Record>& records);

// Notes: rows trained for different numbers of steps; how many photos a scene has for training.
void add_training_notes(Table& table, const std::vector<Record>& records);

}  // namespace glint
