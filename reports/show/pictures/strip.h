// SPDX-License-Identifier: MIT
// strip.png: the maps of a render beside their ground truth, to look at. Depths have one scale for
// all methods of a scene and errors one gain; both are printed below.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/service.h"
#include "glint/scene/scene.h"
#include "reports/show/pictures/depth_scale.h"

namespace glint {

inline constexpr std::size_t kStripViews =
    4;                                     // rows of a run's strip, evenly spread over the views
inline constexpr float kErrorGain = 4.0f;  // |render - truth| is shown this much brighter

// The panels of a run, alike in all its strips: truth, render, error, then each map that any view
// has under renders/, followed by its truth.
std::vector<std::string> strip_titles(const fs::path& run, const std::vector<View>& views);

// renders/<view>/strip.png of every view and `run`/strip.png, from the files under `run`/renders. A
// map that only this view lacks, or that is damaged (a warning says so), is grey. Errors
// (kBadReference): rgb.exr is missing or damaged.
inline constinit Service<void(const fs::path& run, const std::vector<View>& views)> write_strips{
    "drawing strips", "use the full build"};

struct TitledPicture {
  std::string title;
  Image picture;  // [H][W][1 or 3] as displayed; all of one size
};
// The layers of one frame of a camera path on one picture, for videos.
inline constinit Service<Image(const std::vector<TitledPicture>& pictures)> frame_sheet{
    "drawing layers side by side", "use the full build"};

}  // namespace glint
