// SPDX-License-Identifier: MIT
// The methods of a store as figures name them: the same words, colours and lines in all.
#pragma once

#include <string>
#include <vector>

#include "reports/records/records.h"

namespace glint {

// "2DGS"; of a variant that is named by what it lacks, with its method: "GLINT, w/o G_refl". Of
// imported renders, which no registry knows, their id.
std::string method_title(const std::string& id);

// Every method with a finished record: methods, then variants, each by id. The place in the list is
// the index of series_style().
std::vector<std::string> figure_methods(const std::vector<Record>& records);

}  // namespace glint
