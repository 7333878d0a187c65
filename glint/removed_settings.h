// SPDX-License-Identifier: MIT
// Settings of before that are none any more: the option is gone, or a method has but one value of
// it. Run folders and profiles that hold that value go on to work.
#pragma once

#include <string>

#include "glint/core/config.h"

namespace glint {

// Drops them from `config`; `offered`: the settings that the method has. Errors (kUsage): one has
// another value there; names it, both values and what to do.
void drop_removed_settings(const std::string& method, const Json& offered, Json& config);

}  // namespace glint
