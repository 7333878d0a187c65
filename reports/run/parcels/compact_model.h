// SPDX-License-Identifier: MIT
// A trained run's model for whoever fuses its depth: what the training views' depth does not depend
// on is left out, the rest is packed in as few bits as keep that depth. Which that is, no method
// has to say: it is tried, by rendering.
#pragma once

#include <string>
#include <vector>

#include "reports/run/parcels/depth_check.h"
#include "reports/run/parcels/surfel_code.h"
#include "reports/run/records/run_folder.h"

namespace glint {

inline constexpr double kDepthLimit = 1e-4;     // metres, of the mean difference
inline constexpr double kOneSidedLimit = 1e-3;  // share of pixels

// A file of the model: surfels, or bytes as they are.
struct CompactFile {
  std::string name;
  bool surfels = false;
  SurfelCode code;        // of surfels
  std::size_t count = 0;  // surfels of the whole file
  bool empty = false;     // surfels: not needed, one that nobody sees stands for all
  std::string bytes;      // of others
  bool zeroed = false;    // others: its arrays are zeros, since depth does not depend on them
};

struct CompactModel {
  std::vector<CompactFile> files;
  DepthDifference difference;  // from the whole model's depth, over all training views
  double tolerance = 0;        // of the grids, metres; 0: floats as they are
};

// Of the files that the run's training saved, env.json apart. Errors: those of loading and
// rendering the model; kBadPrediction: not trained.
CompactModel compact_model(const RunSpec& spec, const Scene& scene, double limit = kDepthLimit);

// The file as a method loads it. Errors (kEnvironment): as write_file.
void write_compact_file(const CompactFile& file, const fs::path& folder);

}  // namespace glint
