// SPDX-License-Identifier: MIT
// What each stage of a run is made from, field by field: the stages before (their keys), resolved
// options, code, the device's kind, and what the machine has (weights, Open3D). The hash of such a
// document is the stage's key (stage_files.h). Options are under the names of profiles and configs.
#pragma once

#include <optional>
#include <string>

#include "glint/method.h"
#include "metrics/fusion/tsdf.h"
#include "metrics/mesh/mesh_protocol.h"
#include "reports/run/bench/stages.h"

namespace glint {

// `data`: a document of scene_source.h. Errors (kUsage): unknown method or field.
Json train_document(
    const std::string& method, const Json& overrides, const RunOptions& options, const Json& data
);
Json render_document(const std::string& method, const std::string& train_key);
Json mesh_document(
    const std::string& method, const std::string& train_key, const TsdfOptions& options
);
// That of a mesh stage that ended without a mesh, which more memory may give: with the limit, and
// the machine's memory where the limit is a share of that.
Json document_without_mesh(Json document, const TsdfOptions& options);

struct ScoreInputs {
  std::string render_key, mesh_key;
  std::string truth;  // truth_content()
};
// Without timing: nothing was timed.
Json score_document(
    const std::string& method,
    const ScoreInputs& inputs,
    const MeshProtocol& protocol,
    const std::optional<TimingOptions>& timing
);

// Options as a document has them under that name; fields that this version does not know any more
// are left out. Errors: kUsage, and nlohmann::json::exception where there are none.
template <class Options>
Options options_in(const Json& document, const char* name) {
  Options options;
  Json fields = Json::object();
  const Json known = config_to_json(options);
  for (const auto& [field, value] : document.at(name).items())
    if (known.contains(field)) fields[field] = value;
  config_from_json(options, fields, name);
  return options;
}

}  // namespace glint
