// SPDX-License-Identifier: MIT
#include "reports/show/pictures/strip.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "glint/core/presence.h"
#include "glint/drawing/color_maps.h"
#include "glint/drawing/picture_grid.h"
#include "glint/scene/image_files.h"
#include "metrics/metric.h"
#include "reports/run/records/run_folder.h"
#include "reports/show/pictures/layers.h"

namespace glint {

namespace {

// A map of a render, and behind it a panel of its truth where any view has that.
struct MapPanel {
  MapRow map;
  bool truth = false;
};

// What all strips of a run share.
struct StripPlan {
  fs::path run;
  std::vector<MapPanel> panels;
  DepthScale scale;
};

StripPlan plan_strips(const fs::path& run, const std::vector<View>& views) {
  StripPlan plan{run, {}, depth_scale({run}, views)};
  for (const MapRow& row : maps()) {
    if (row.shown_file().empty() || row.id == "rgb") continue;  // the image leads every strip
    const auto rendered = [&](const View& view) {
      return is_there(view_folder(run, view.name) / row.shown_file());
    };
    const auto has_truth = [&](const View& view) { return view.truth.has(row); };
    if (std::any_of(views.begin(), views.end(), rendered))
      plan.panels.push_back({row, std::any_of(views.begin(), views.end(), has_truth)});
  }
  return plan;
}

struct StripColumns {
  std::vector<std::string> titles = {"truth", "rendered", fmt::format("error x {}", kErrorGain)};
  std::set<std::size_t> truths;  // which stay beside their map
};

StripColumns columns_of(const StripPlan& plan) {
  StripColumns columns;
  for (const MapPanel& panel : plan.panels) {
    columns.titles.emplace_back(panel.map.title);
    if (!panel.truth) continue;
    columns.truths.insert(columns.titles.size());
    columns.titles.push_back(fmt::format("{}, truth", panel.map.title));
  }
  return columns;
}

// Of the render as it is scored, clamped to [0, 1].
Image error_panel(const Image& render, const Image& truth) {
  Image error(truth.width(), truth.height(), 3);
  for (std::size_t i = 0; i < error.values().size(); ++i) {
    const float scored = std::clamp(render.values()[i], 0.0f, 1.0f);
    error.values()[i] = std::min(1.0f, kErrorGain * std::abs(scored - truth.values()[i]));
  }
  return error;
}

// Empty where there is no such map.
Image panel_of(const LayerMaps& maps, const MapRow& row, DepthScale scale) {
  const auto map = maps.find(std::string(row.id));
  if (map == maps.end()) return {};
  if (row.kind == MapKind::kShare) return fit_panel(grey_picture(map->second));
  return fit_panel(layer_picture(layer_of(row), map->second, scale));
}

PanelRow row_of(const StripPlan& plan, const View& view) {
  const fs::path folder = view_folder(plan.run, view.name);
  const Image render = read_image(render_file(folder, *find_map("rgb")), 3);
  Image scored = render;
  if (const MaskImage counted = mask_of_map(view.counted); !counted.empty())
    take_reference_where_uncounted(counted, view.rgb, scored);
  PanelRow row = {fit_panel(view.rgb), fit_panel(render), fit_panel(error_panel(scored, view.rgb))};
  const LayerMaps rendered = rendered_layers(folder, &view), truth = true_layers(view);
  for (const MapPanel& panel : plan.panels) {
    row.push_back(panel_of(rendered, panel.map, plan.scale));
    if (panel.truth) row.push_back(panel_of(truth, panel.map, plan.scale));
  }
  return row;
}

std::vector<LegendLine> legend_of(const StripPlan& plan, const std::vector<const View*>& views) {
  std::string names;
  for (const View* view : views) names += (names.empty() ? "" : ", ") + view->name;
  std::string shares;
  bool depths = false;
  for (const MapPanel& panel : plan.panels) {
    if (panel.map.kind == MapKind::kShare)
      shares += fmt::format("{}{}", shares.empty() ? "" : ", ", panel.map.title);
    depths = depths || panel.map.kind == MapKind::kDepth;
  }
  std::vector<LegendLine> legend = {
      {fmt::format("views: {}", names)},
      {fmt::format("error: |rendered - truth| x {}, black: none", kErrorGain)}};
  if (!shares.empty()) legend.push_back({shares + ": black 0, white 1"});
  if (depths)
    legend.push_back(
        {fmt::format("depth: {:.2f} m", plan.scale.low),
         LegendBar::kDepth,
         fmt::format(
             "{:.2f} m, from {}",
             plan.scale.high,
             plan.scale.from_truth ? "the true depths of all test views" : "this run's own depths"
         )}
    );
  return legend;
}

void write_strip(
    const fs::path& path, const StripPlan& plan, const std::vector<const View*>& views
) {
  StripColumns columns = columns_of(plan);
  PictureGrid grid{std::move(columns.titles), {}, legend_of(plan, views)};
  grid.bands = true;
  grid.joined = std::move(columns.truths);
  for (const View* view : views) grid.rows.push_back(row_of(plan, *view));
  write_png(path, draw_bytes(draw_grid(std::move(grid))));
}

}  // namespace

std::vector<std::string> strip_titles(const fs::path& run, const std::vector<View>& views) {
  return columns_of(plan_strips(run, views)).titles;
}

namespace {
void draw_strips(const fs::path& run, const std::vector<View>& views) {
  if (views.empty()) return;
  const StripPlan plan = plan_strips(run, views);
  for (const View& view : views)
    write_strip(view_folder(run, view.name) / "strip.png", plan, {&view});
  std::vector<const View*> spread;
  const std::size_t count = std::min(kStripViews, views.size());
  for (std::size_t i = 0; i < count; ++i) spread.push_back(&views[i * views.size() / count]);
  write_strip(run / "strip.png", plan, spread);
}

Image draw_frame_sheet(const std::vector<TitledPicture>& pictures) {
  PictureGrid grid;
  grid.bands = true;
  grid.rows.emplace_back();
  for (const auto& [title, picture] : pictures) {
    grid.titles.push_back(title);
    grid.rows[0].push_back(fit_panel(picture));
  }
  return draw_image(draw_grid(std::move(grid)));
}
}  // namespace

GLINT_PROVIDE(write_strips, draw_strips)
GLINT_PROVIDE(frame_sheet, draw_frame_sheet)

}  // namespace glint
