// SPDX-License-Identifier: MIT
// Is a run what its keys, its record and its numbers say? Everything is computed again from what
// lies in its folder and compared; nothing is written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/run/provenance/checked.h"
#include "reports/run/records/records.h"
#include "reports/run/records/run_folder.h"

namespace glint {

struct RunToVerify {
  fs::path folder;
  fs::path dataset;                // empty: where config.json says that it lies
  std::string loader;              // of the dataset; empty: the surest
  const Record* record = nullptr;  // null: not recorded
};

class RunVerifier {
 public:
  // `fast`: metrics are not computed again.
  explicit RunVerifier(bool fast) : fast_(fast), hashes_("glint_verify") {}

  // What was looked at. Errors (kBadPrediction): no run; Interrupted.
  std::vector<Checked> verify(const RunToVerify& run);

 private:
  friend class RunExamination;
  const Scene& scene_of(const RunSpec& spec, const std::string& loader);

  bool fast_;
  TemporaryFolder hashes_;  // of files of the data, each read once
  std::string scene_name_;  // which scene is loaded
  Scene scene_;
};

}  // namespace glint
