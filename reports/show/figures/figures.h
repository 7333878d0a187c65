// SPDX-License-Identifier: MIT
// Figures of a profile's results as PNG and PDF: what methods render beside the truth, and curves.
// One view a scene, chosen by a rule; one range of colours for all methods
// (docs/reference/reports.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/service.h"
#include "reports/run/records/run_folder.h"

namespace glint {

// What pictures show in place of what their rules choose.
struct FigureView {
  std::vector<std::string> scenes = {};  // globs; none: all
  std::string view = {};                 // name of a test view; empty: kViewRule
  std::vector<std::string> crops = {};   // parse_crop(), pixels of the view; none: choose_crops()
};

struct FigureOptions {
  fs::path folder;                            // OUT/PROFILE with records.jsonl and runs/
  std::function<Scene(const RunSpec&)> load;  // the data that a run was scored against
  std::vector<std::string> methods = {};      // MethodChoice
  FigureView shown = {};
};

// FOLDER/figures/{qualitative, depth_decomposition, transparency, radiance, ablation, curves,
// growth, f1, meshes}.png, each with a PDF beside it; returns the PNGs of those that have something
// to show. What is absent inside a figure says "missing"; scenes without data are left out of
// figures with maps, with a warning. Errors: those of read_records(), kUsage (no such scene or test
// view, a crop outside the view), kEnvironment (disk).
inline constinit Service<std::vector<fs::path>(const FigureOptions&)> write_figures{
    "drawing figures", "use the full build"};

// growth.png of runs that are named, not of records.
struct GrowthOptions {
  std::vector<std::string> runs;     // folders of runs, or folders above them
  fs::path folder;                   // where it goes
  std::vector<std::string> methods;  // globs; none: all
  std::vector<std::string> scenes;   // likewise
};
// Errors (kUsage): no folder, or no run there; those of read_run_spec(); kEnvironment (disk).
inline constinit Service<std::vector<fs::path>(const GrowthOptions&)> write_growth{
    "drawing figures", "use the full build"};

// What is found here of kFontFamily (glint/drawing/canvas.h).
inline constinit Service<std::string()> figures_font{"the font of figures", "use the full build"};

}  // namespace glint
