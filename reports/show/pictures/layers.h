// SPDX-License-Identifier: MIT
// What the page, figures and strips show of a view: the maps of one render or of the truth, what
// compares the two, and how each becomes a picture. One range for all methods of a scene.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/files.h"
#include "glint/scene/scene.h"
#include "reports/show/pictures/depth_scale.h"

namespace glint {

enum class LayerStyle { kPicture, kDepth, kNormal, kShare, kError, kAngle };

struct PageLayer {
  std::string id;     // of the map; "error", "angle"
  std::string title;  // as shown
  LayerStyle style = LayerStyle::kPicture;
};
// The maps of the table that methods render; behind the image its error, behind the normal its
// angle to the true one.
std::vector<PageLayer> page_layers();
PageLayer layer_of(const MapRow& row);

// Limits of the colours of errors (mean over channels of |render - truth|) and of angles (degrees).
inline constexpr float kPageErrorHigh = 0.25f, kPageAngleHigh = 45;

// Layer id -> map; absent: not rendered, damaged (a warning says so), or of another size than the
// view. "error" (of the render clamped to [0, 1]) and "angle" (NaN where the truth has no normal)
// need `view`; nullptr: the truth is not at hand.
using LayerMaps = std::map<std::string, Image>;
LayerMaps rendered_layers(const fs::path& view_folder, const View* view);
// Adds "error" and "angle" to maps of this view's size, where it has the truth.
void add_errors(const View& view, LayerMaps& maps);
// One of them; empty where that would be absent.
Image rendered_layer(const fs::path& view_folder, const std::string& id, const View& view);
// Is there a file for it? It may be damaged.
bool has_rendered_layer(const fs::path& view_folder, const std::string& id, const View& view);
// The truth under the same ids; parts of the image as displayed.
LayerMaps true_layers(const View& view);

Image layer_picture(const PageLayer& layer, const Image& map, const DepthScale& scale);

// Maps of the set that are shown, in the order of the table.
std::vector<MapRow> maps_in(const MapSet& maps);

// Id, title, style, and for colour maps unit, limits, colours at equal steps from low to high, and
// the decimals of the values that the page's probe has.
Json layers_json(const std::vector<PageLayer>& layers, const DepthScale& scale);

}  // namespace glint
