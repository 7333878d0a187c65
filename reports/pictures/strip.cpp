// SPDX-License-Identifier: MIT
#include "reports/pictures/strip.h"

#include <algorithm>
#include <cmath>

#include "glint/scene/image_files.h"
#include "reports/pictures/picture_grid.h"
#include "reports/records/run_folder.h"

namespace glint {

namespace {

Image show_color(const Image& color, DepthScale) { return color; }
Image show_grey(const Image& map, DepthScale) {
  Image color(map.width(), map.height(), 3);
  for (std::size_t i = 0; i < color.values().size(); ++i)
    color.values()[i] = std::clamp(map.values()[i / 3], 0.0f, 1.0f);
  return color;
}
Image show_depth(const Image& depth, DepthScale scale) {
  return colorize_depth(depth, scale.low, scale.high);
}
Image show_normal(const Image& normal, DepthScale) { return colorize_normal(normal); }

// A map of a render, and the panel of its ground truth behind it where there is one.
struct MapPanel {
  const char* title;
  const char* file;
  int channels;
  Image (*show)(const Image& map, DepthScale scale);
  const char* true_title = nullptr;
  const Image GroundTruth::*truth = nullptr;
};

constexpr MapPanel kMapPanels[] = {
    {"base colour", "interface.png", 3, show_color},
    {"transmission", "transmission.png", 3, show_color},
    {"reflection", "reflection.png", 3, show_color},
    {"transparency t", "transparency.exr", 1, show_grey},
    {"specularity k_s", "specularity.exr", 1, show_grey},
    {"interface depth", "depth.exr", 1, show_depth, "true depth", &GroundTruth::depth},
    {"transmission depth",
     "behind_depth.exr",
     1,
     show_depth,
     "true depth behind",
     &GroundTruth::behind_depth},
    {"normal", "normal.exr", 3, show_normal, "true normal", &GroundTruth::normal}};

// What all strips of a run share.
struct StripPlan {
  fs::path run;
  std::vector<MapPanel> panels;  // truth is null where no view has any
  DepthScale scale;
};

StripPlan plan_strips(const fs::path& run, const std::vector<View>& views) {
  StripPlan plan{run, {}, depth_scale({run}, views)};
  for (MapPanel panel : kMapPanels) {
    const auto rendered = [&](const View& view) {
      return fs::exists(view_folder(run, view.name) / panel.file);
    };
    const auto has_truth = [&](const View& view) {
      return panel.truth != nullptr && !(view.truth.*panel.truth).empty();
    };
    if (std::none_of(views.begin(), views.end(), rendered)) continue;
    if (std::none_of(views.begin(), views.end(), has_truth)) panel.truth = nullptr;
    plan.panels.push_back(panel);
  }
  return plan;
}

std::vector<std::string> titles_of(const StripPlan& plan) {
  std::vector<std::string> titles = {"truth", "rendered", fmt::format("error x {}", kErrorGain)};
  for (const MapPanel& panel : plan.panels) {
    titles.push_back(panel.title);
    if (panel.truth != nullptr) titles.push_back(panel.true_title);
  }
  return titles;
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

Image shown(const Image& map, const MapPanel& panel, DepthScale scale) {
  return map.empty() ? Image() : fit_panel(panel.show(map, scale));
}

std::vector<Image> row_of(const StripPlan& plan, const View& view) {
  const fs::path folder = view_folder(plan.run, view.name);
  const Image render = read_image(folder / "rgb.exr", 3);
  std::vector<Image> row = {
      fit_panel(view.rgb), fit_panel(render), fit_panel(error_panel(render, view.rgb))};
  for (const MapPanel& panel : plan.panels) {
    const fs::path file = folder / panel.file;
    const Image map = fs::exists(file) ? read_image(file, panel.channels) : Image();
    row.push_back(shown(map, panel, plan.scale));
    if (panel.truth != nullptr) row.push_back(shown(view.truth.*panel.truth, panel, plan.scale));
  }
  return row;
}

std::vector<LegendLine> legend_of(const StripPlan& plan, const std::vector<const View*>& views) {
  std::string names;
  for (const View* view : views) names += (names.empty() ? "" : ", ") + view->name;
  const auto shows = [&](auto show) {
    return std::any_of(plan.panels.begin(), plan.panels.end(), [&](const MapPanel& panel) {
      return panel.show == show;
    });
  };
  std::vector<LegendLine> legend = {
      {fmt::format("views: {}", names)},
      {fmt::format("error: |rendered - truth| x {}, black: none", kErrorGain)}};
  if (shows(show_grey)) legend.push_back({"t, k_s: black 0, white 1"});
  if (shows(show_depth))
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
  PictureGrid grid{titles_of(plan), {}, legend_of(plan, views)};
  for (const View* view : views) grid.rows.push_back(row_of(plan, *view));
  write_png(path, draw_grid(grid));
}

}  // namespace

std::vector<std::string> strip_titles(const fs::path& run, const std::vector<View>& views) {
  return titles_of(plan_strips(run, views));
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
}  // namespace

GLINT_PROVIDE(write_strips, draw_strips)

}  // namespace glint
