// SPDX-License-Identifier: MIT
#include "reports/show/figures/figures.h"

#include <utility>

#include "reports/show/figures/curve_figures.h"
#include "reports/show/figures/figure_methods.h"
#include "reports/show/figures/growth_figure.h"
#include "reports/show/figures/map_figures.h"
#include "reports/show/figures/mesh_figure.h"

namespace glint {

namespace {

// A figure of earlier records with nothing to show now does not stay behind.
void keep(const fs::path& png, const Drawing& drawing, std::vector<fs::path>& written) {
  if (drawing.empty()) {
    std::error_code code;
    fs::remove(png, code);
    fs::remove(fs::path(png).replace_extension(".pdf"), code);
    return;
  }
  write_drawing(png, drawing);
  written.push_back(png);
}

std::vector<fs::path> draw_figures(const FigureOptions& options) {
  const MethodChoice choice{options.methods};
  const auto records = read_records(options.folder / "records.jsonl");
  const auto all_scenes = figure_scenes(records, options);
  const auto scenes = with_chosen_methods(all_scenes, choice);
  const fs::path folder = options.folder / "figures";
  std::vector<fs::path> written;
  keep(folder / "qualitative.png", draw_grid(qualitative_figure(scenes)), written);
  keep(folder / "depth_decomposition.png", draw_grid(depth_figure(scenes)), written);
  keep(folder / "transparency.png", draw_grid(transparency_figure(scenes)), written);
  keep(folder / "radiance.png", draw_grid(radiance_figure(scenes)), written);
  keep(folder / "ablation.png", draw_grid(ablation_figure(all_scenes)), written);
  keep(folder / "curves.png", curves_figure(records, options.folder, choice), written);
  keep(folder / "growth.png", growth_figure(growth_runs(options, records)), written);
  keep(folder / "f1.png", f1_figure(records, choice), written);
  keep(folder / "meshes.png", draw_grid(meshes_figure(scenes)), written);
  return written;
}

std::string font() { return found_font_family(); }

}  // namespace

GLINT_PROVIDE(write_figures, draw_figures)
GLINT_PROVIDE(figures_font, font)

}  // namespace glint
