// SPDX-License-Identifier: MIT
// How far a profile is.
#pragma once

#include "reports/verbs/verb.h"

namespace glint {

// Of each cell its stages and why they are not done; `tasks`: the names of those alone that are not
// done. Errors: as make_plan, identify_source.
int print_status(const CommonOptions& common, bool tasks);

}  // namespace glint
