// SPDX-License-Identifier: MIT
// What the page knows without opening a scene: tables, records, failures, machines.
#pragma once

#include <vector>

#include "reports/show/page/page_scenes.h"

namespace glint {

Json page_summary(
    const PageOptions& options,
    const std::vector<Table>& tables,
    const std::vector<Record>& records,
    const std::vector<PageScene>& scenes
);

}  // namespace glint
