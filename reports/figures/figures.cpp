// SPDX-License-Identifier: MIT
#include "reports/figures/figures.h"

#include "glint/scene/image_files.h"
#include "reports/figures/curve_figures.h"
#include "reports/figures/map_figures.h"
#include "reports/figures/mesh_figure.h"

namespace glint {

namespace {

// A figure of earlier records with nothing to show now does not stay behind.
void keep(const fs::path& path, const PictureGrid& grid, std::vector<fs::path>& written) {
  if (grid.rows.empty()) {
    std::error_code code;
    fs::remove(path, code);
    return;
  }
  write_png(path, draw_grid(grid));
  written.push_back(path);
}

std::vector<fs::path> draw_figures(const FigureOptions& options) {
  const auto records = read_records(options.folder / "records.jsonl");
  const auto scenes = figure_scenes(records, options);
  const fs::path folder = options.folder / "figures";
  std::vector<fs::path> written;
  keep(folder / "qualitative.png", qualitative_figure(scenes), written);
  keep(folder / "depth_decomposition.png", depth_figure(scenes), written);
  keep(folder / "transparency.png", transparency_figure(scenes), written);
  keep(folder / "radiance.png", radiance_figure(scenes), written);
  keep(folder / "ablation.png", ablation_figure(scenes), written);
  keep(folder / "curves.png", curves_figure(records, options.folder), written);
  keep(folder / "f1.png", f1_figure(records), written);
  keep(folder / "meshes.png", meshes_figure(scenes), written);
  return written;
}

}  // namespace

GLINT_PROVIDE(write_figures, draw_figures)

}  // namespace glint
