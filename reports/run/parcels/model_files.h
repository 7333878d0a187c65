// SPDX-License-Identifier: MIT
// The files that a method saved, as far as their kind is known: surfels, arrays, other bytes.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "reports/run/parcels/compact_model.h"

namespace glint {

struct SavedFile {
  std::string name, bytes;
  std::optional<SurfelCloud> cloud;  // of a PLY file with surfels
  std::vector<float> seen;           // [N], of the cloud: see pixels_seen()
  bool arrays = false;               // a safetensors file
};

// Of the run's training. Errors (kBadPrediction): not trained, a file is missing.
std::vector<SavedFile> saved_files(const fs::path& run);

// What is made of them.
struct ModelCut {
  double tolerance = 0;                       // of grids, metres; 0: floats as they are
  float drop_below = kDropNone;               // surfels that are seen at so few pixels
  bool draft = false;                         // to be looked at, not to be sent
  std::map<std::string, bool> needed;         // by file; absent: it is
  std::map<std::string, bool> needed_extras;  // by file and channel, "interface.ply specular"
  bool needs(const std::string& file) const;
  bool needs_extra(const std::string& file, const std::string& channel) const;
};

// Files with arrays that have a row for each surfel keep the rows of those that are kept.
std::vector<CompactFile> cut_files(const std::vector<SavedFile>& files, const ModelCut& cut);

}  // namespace glint
