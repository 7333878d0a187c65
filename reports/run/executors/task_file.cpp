// SPDX-License-Identifier: MIT
#include "reports/run/executors/task_file.h"

#include <sstream>

#include "glint/core/error.h"

namespace glint {

void write_task_file(
    const fs::path& file, const std::vector<const PlanCell*>& cells, const CellQueue& queue
) {
  std::string text;
  for (const PlanCell* cell : cells) {
    const auto seconds = queue.seconds_of(*cell);
    text +=
        fmt::format("{}\t{}\n", cell->cell.text(), seconds ? fmt::format("{:.0f}", *seconds) : "");
  }
  write_file(file, text);
}

std::vector<std::string> cells_of_tasks(const fs::path& file) {
  std::istringstream lines(with_exit_code(ExitCode::kUsage, [&] { return read_file(file); }));
  std::vector<std::string> cells;
  for (std::string line; std::getline(lines, line);)
    cells.push_back(line.substr(0, line.find('\t')));
  return cells;
}

std::string cell_of_task(const fs::path& file, std::size_t task) {
  const auto cells = cells_of_tasks(file);
  GLINT_CHECK(
      task < cells.size(),
      kUsage,
      "--task {}: {} has {} lines, the first is 0",
      task,
      file.string(),
      cells.size()
  );
  return cells[task];
}

}  // namespace glint
