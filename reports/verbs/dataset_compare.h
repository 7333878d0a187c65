// SPDX-License-Identifier: MIT
#pragma once

#include "reports/verbs/verb.h"

namespace glint {

// `dataset compare`, below the verb `dataset`.
void add_dataset_compare(CommandLine& line, CLI::App& dataset);

}  // namespace glint
