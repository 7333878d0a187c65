// SPDX-License-Identifier: MIT
// Options of verbs that read a dataset folder: its loader, and how priors of other programs are
// stored. Verbs that start trainings take the same from scene.json or from a profile's scene.
#pragma once

#include "datasets/dataset.h"
#include "reports/verbs/verb.h"

namespace glint {

// `load` lives as long as the verb.
void add_load_options(CLI::App& verb, LoadOptions& load);

}  // namespace glint
