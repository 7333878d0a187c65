// SPDX-License-Identifier: MIT
// What exporters of several formats write alike.
#pragma once

#include <array>
#include <functional>

#include "datasets/export/exporter.h"

namespace glint {

// Calls f(view) on all cores, with progress under `title`. The first error is thrown on.
void for_each_view(
    const ExportInput& input,
    const std::string& title,
    const std::function<void(const ExportView&)>& f
);

// Pictures as 8-bit PNG, at folder / path_of(view). Notes values that 8 bits do not hold.
void write_pictures(
    const ExportInput& input,
    const fs::path& folder,
    const std::function<fs::path(const ExportView&)>& path_of,
    ExportReport& report
);

// masks/, depths/, normals/ and priors/ (datasets/side_maps.h).
void write_side_maps(const ExportInput& input, const fs::path& folder, ExportReport& report);

// Points as PLY; with normals, too, zero where there are none: 3DGS asks for them. False: no
// points.
enum class PointNormals { kAsTheyAre, kAlways };
bool write_points(
    const ExportInput& input,
    const fs::path& folder,
    const std::string& name,
    PointNormals normals,
    ExportReport& report
);

// A view's name in letters, digits, '_' and '-': what every program and every separator agrees on.
std::string export_name(const std::string& view);
// Names as "0000_name": numbers in the order of `views`.
void number_names(std::vector<ExportView>& views);

// "40 views (35 train, 5 test)"
std::string count_views(const ExportInput& input);

// Rows of the camera-to-world matrix with OpenGL axes (transforms_json.h).
std::array<std::array<double, 4>, 4> opengl_world_from_cam(const Camera& camera);

}  // namespace glint
