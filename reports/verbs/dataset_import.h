// SPDX-License-Identifier: MIT
#pragma once

#include "reports/verbs/verb.h"

namespace glint {

// `dataset import`, below the verb `dataset`.
void add_dataset_import(CommandLine& line, CLI::App& dataset);

}  // namespace glint
