// SPDX-License-Identifier: MIT
// Lists of cells for engines that start `glint-bench all --tasks FILE --task N`: a line for each
// cell, "scene/method/seed", then columns for people.
#pragma once

#include "reports/run/executors/cell_queue.h"

namespace glint {

// With the seconds that each is expected to take, where that is known.
void write_task_file(
    const fs::path& file, const std::vector<const PlanCell*>& cells, const CellQueue& queue
);

// All cells of the file. Errors (kUsage): no such file.
std::vector<std::string> cells_of_tasks(const fs::path& file);

// Errors (kUsage): the file has no such line; it says how many there are.
std::string cell_of_task(const fs::path& file, std::size_t task);

}  // namespace glint
