// SPDX-License-Identifier: MIT
// What is wrong with data, as `dataset check` tells it.
#pragma once

#include <string>
#include <vector>

#include "datasets/findings.h"
#include "reports/verbs/verb.h"

namespace glint {

// What any `dataset check` prints, and its exit code; `when_none`: "nothing wrong".
int print_findings(
    const CommonOptions& common,
    const std::string& what,
    const std::vector<Finding>& findings,
    const std::string& when_none
);
Json findings_json(const std::vector<Finding>& findings);
// A line each; of what is found in many places in the same words, as one field of a file that all
// its frames have, the first three and the number of the others.
std::string findings_text(const std::vector<Finding>& findings);

}  // namespace glint
