// SPDX-License-Identifier: MIT
// Conformance vectors: small inputs, the command that scores them, and the value it must print,
// made by other software or a closed form (scripts/make_conformance.py). Other implementations can
// be checked with the same files.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/files.h"

namespace glint {

// Compiled in, by path below metrics/conformance/.
const std::map<std::string, std::string_view>& conformance_files();
// Writes them into a folder. Errors: write_file()'s.
void export_conformance(const fs::path& folder);

struct ConformanceVector {
  std::string id;                      // "psnr/mask"
  std::vector<std::string> arguments;  // program, then its arguments; files relative to the folder
  std::string value;                   // id of the metric in what it prints
  double expected = 0, tolerance = 0;  // absolute, in the metric's unit
  std::string source, convention;      // what made the value; what it stands for
  template <class V>
  void visit(V&& v) {
    v("id", id, "name of the vector");
    v("arguments", arguments, "program and its arguments");
    v("value", value, "metric id");
    v("expected", expected, "value");
    v("tolerance", tolerance, "absolute");
    v("source", source, "tool and version, or closed form");
    v("convention", convention, "what is fixed by it");
  }
};

// Of vectors.json in a folder. Errors (kBadReference): missing or damaged file, an id twice.
std::vector<ConformanceVector> read_vectors(const fs::path& folder);

enum class VectorStatus { kPassed, kFailed, kSkipped };
NLOHMANN_JSON_SERIALIZE_ENUM(
    VectorStatus,
    {{VectorStatus::kPassed, "passed"},
     {VectorStatus::kFailed, "failed"},
     {VectorStatus::kSkipped, "skipped"}}
)

struct VectorResult {
  ConformanceVector vector;
  VectorStatus status = VectorStatus::kFailed;
  double found = 0;
  std::string note;  // why it was skipped, or what the program said when it failed
};

// Runs each command once, in this process. What the machine lacks (exit code 6) is skipped.
std::vector<VectorResult> run_vectors(
    const std::vector<ConformanceVector>& vectors, const fs::path& folder
);
// Against values by vector id that another implementation printed; absent ones are skipped.
std::vector<VectorResult> check_values(
    const std::vector<ConformanceVector>& vectors, const Json& values
);

}  // namespace glint
