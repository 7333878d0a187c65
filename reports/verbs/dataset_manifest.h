// SPDX-License-Identifier: MIT
// `dataset info` and `check` of a published dataset: by its id (below --data), or by the folder of
// that name.
#pragma once

#include <optional>
#include <string>

#include "reports/verbs/verb.h"

namespace glint {

// The exit code; nothing: `name` is no published dataset.
std::optional<int> show_manifest(const CommonOptions& common, const std::string& name);
// Missing scenes and scenes that are not as published are findings: exit code 4.
std::optional<int> check_manifest(const CommonOptions& common, const std::string& name);

}  // namespace glint
