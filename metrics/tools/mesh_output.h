// SPDX-License-Identifier: MIT
// The results of glint-mesh: text for people, CSV, one JSON document, coloured surfaces, and the
// curves as a picture.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "glint/drawing/canvas.h"
#include "metrics/mesh/mesh_scores.h"
#include "metrics/tools/mesh_inputs.h"

namespace glint {

struct MeshReport {
  SurfaceInput prediction, reference;
  fs::path dataset;  // whose cameras culled; may be empty
  MeshProtocol protocol;
  std::string gltf_up;  // of a glTF among them: y or z
  std::vector<std::string> warnings;
  MeshScores scores;
  std::vector<ThresholdScores> curve;
  std::optional<double> color_range_m;  // where a coloured surface was written
};

void print_mesh_text(const MeshReport& report, std::ostream& out);
// One row, unrounded.
void print_mesh_csv(const MeshReport& report, std::ostream& out);
// Unrounded numbers, protocol, what cleaning and culling did.
Json mesh_report_json(const MeshReport& report);
void print_mesh_json(const MeshReport& report, std::ostream& out);

// The surface with each vertex coloured by its distance to `target`: yellow (0) over green to
// violet
// (`range_m` and beyond). Errors (kEnvironment): cannot be written.
void write_colored(
    const fs::path& path, const Surface& surface, const Surface& target, double range_m
);

// F1, precision and recall over the threshold. `curve` by ascending threshold, at least two.
Drawing draw_f1_curve(const std::vector<ThresholdScores>& curve);

}  // namespace glint
