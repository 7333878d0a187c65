// SPDX-License-Identifier: MIT
#pragma once

#include "reports/verbs/verb.h"

namespace glint {

// `dataset export`, below the verb `dataset`.
void add_dataset_export(CommandLine& line, CLI::App& dataset);

}  // namespace glint
