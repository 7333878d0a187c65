// SPDX-License-Identifier: MIT
// Is training deterministic? The same cell is trained several times, rendered, meshed and scored;
// files are compared by their bytes, maps and metrics by their values.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "metrics/fusion/tsdf.h"
#include "metrics/mesh/mesh_protocol.h"
#include "reports/records/run_folder.h"

namespace glint {

struct AuditOptions {
  RunOptions run{60, 0};
  int repeats = 2;            // trainings with the same threads
  bool other_threads = true;  // and with one thread, and with two
  TsdfOptions tsdf;
  MeshProtocol mesh;
  fs::path folder;  // runs lie in FOLDER/METHOD/RUN
};

struct MapDifference {
  double max = 0, rms = 0;  // over all pixels and views, in the map's unit
};

// A training against the first one.
struct AuditedRun {
  std::string name;  // "again", "1 thread"
  int threads = 0;
  std::size_t files = 0;
  std::vector<std::string> differing;         // files
  std::map<std::string, MapDifference> maps;  // by id, of those that differ
};

struct AuditedMethod {
  std::string method;
  std::string failure;  // it could not be trained; empty: it was
  std::vector<AuditedRun> runs;
  std::map<std::string, double> spread;  // metric id -> largest value less smallest, where not 0

  bool same_bytes() const;
};

// What fails is part of the answer. The number of threads is afterwards what it was. Errors:
// Interrupted, those of a lost device.
AuditedMethod audit_method(
    const std::string& method, const Json& config, const Scene& scene, const AuditOptions& options
);

}  // namespace glint
