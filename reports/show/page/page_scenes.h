// SPDX-License-Identifier: MIT
// The scenes of a store as the page shows them, one at a time: pictures, probe values, scores of
// each view, curves, meshes and commands of every run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "glint/core/progress.h"
#include "reports/show/page/page.h"

namespace glint {

struct PageRun {
  const Record* record = nullptr;
  fs::path folder;
  std::optional<RunSpec> spec;  // nothing: no run folder, or a damaged one
};

struct PageScene {
  std::string dataset, name;
  std::vector<PageRun> runs;  // finished and failed, in the order of the records
};

// In the order of the records, which must outlive the result.
std::vector<PageScene> page_scenes(const std::vector<Record>& records, const fs::path& folder);
std::vector<PageScene> page_scenes(std::vector<Record>&& records, const fs::path& folder) = delete;

// Commands that repeat a run: {"what", "command"}; without a spec only the one for the cell.
Json run_commands(const PageRun& run, const PageOptions& options);

// Rendered views and meshes of the runs: what write_scene() advances its progress by.
std::size_t scene_steps(const PageScene& scene);

// Writes pictures/s<index>/, scene_<index>.js, probe_<index>_<view>.js and mesh_<index>_*.js into
// `assets`; beside each picture its bytes as a script, unless all goes into a single file.
void write_scene(
    const PageScene& scene,
    std::size_t index,
    const PageOptions& options,
    const fs::path& assets,
    Progress& progress
);

}  // namespace glint
