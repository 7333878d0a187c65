// SPDX-License-Identifier: MIT
#include "reports/show/figures/map_figures.h"

#include <algorithm>

#include "reports/show/figures/figure_methods.h"
#include "reports/show/figures/map_crops.h"
#include "reports/show/tables/tables.h"

namespace glint {

namespace {

constexpr float kReflectedGain = 4;  // what glass mirrors is faint

const FigureLayers* maps_of(const FigureScene& scene, const std::string& method) {
  const auto it = scene.methods.find(method);
  return it == scene.methods.end() ? nullptr : &it->second;
}

bool has(const FigureLayers* maps, const std::string& id) { return maps && maps->has(id); }

// The layer's picture in its own size; empty where there is none.
Image picture_of(const FigureLayers* maps, const std::string& id, const DepthScale& scale) {
  if (!has(maps, id)) return {};
  const std::vector<PageLayer> layers = page_layers();
  const auto layer = std::find_if(layers.begin(), layers.end(), [&](const PageLayer& candidate) {
    return id == candidate.id;
  });
  const Image map = maps->at(id);
  return map.empty() ? Image() : layer_picture(*layer, map, scale);
}

Image panel_of(const FigureLayers* maps, const std::string& id, const DepthScale& scale) {
  const Image picture = picture_of(maps, id, scale);
  return picture.empty() ? Image() : fit_panel(picture);
}

Image mask_panel(const MaskImage& mask) {
  if (mask.empty()) return {};
  Image picture(mask.width(), mask.height(), 3);
  for (std::size_t i = 0; i < picture.values().size(); ++i)
    picture.values()[i] = mask.values()[i / 3] ? 1.0f : 0.0f;
  return fit_panel(picture);
}

PictureMethods methods_with(const std::vector<FigureScene>& scenes, const std::string& layer) {
  PictureMethods methods;
  for (const FigureScene& scene : scenes)
    for (const auto& [method, maps] : scene.methods)
      if (has(&maps, layer)) methods.insert(method);
  return methods;
}

std::vector<Crop> crops_of(const FigureScene& scene, const PictureMethods& methods) {
  if (!scene.crops.empty()) return scene.crops;
  std::vector<Image> errors;
  for (const std::string& method : methods)
    if (const FigureLayers* maps = maps_of(scene, method); has(maps, "error"))
      if (Image error = maps->at("error"); !error.empty()) errors.push_back(std::move(error));
  std::vector<const Image*> pointers;
  for (const Image& error : errors) pointers.push_back(&error);
  return choose_crops(pointers, scene.glass);
}

std::vector<LegendLine> legend_of(const std::vector<FigureScene>& scenes, bool depth) {
  std::vector<LegendLine> legend{views_line(scenes)};
  if (!depth) return legend;
  for (const FigureScene& scene : scenes)
    legend.push_back(
        {fmt::format("depth of {}: {:.2f} m", scene.name, scene.scale.low),
         LegendBar::kDepth,
         fmt::format("{:.2f} m", scene.scale.high)}
    );
  return legend;
}

LegendLine error_line() {
  return {
      "error, mean over channels: 0",
      LegendBar::kError,
      fmt::format("{:g} and more", kPageErrorHigh)};
}

LegendLine share_line(const std::vector<std::string>& shares) {
  return {fmt::format("{}: 0", fmt::join(shares, ", ")), LegendBar::kShare, "1"};
}

// A row of one layer: the truth, then every method.
PanelRow layer_row(
    const FigureScene& scene, const std::vector<std::string>& methods, const std::string& layer
) {
  PanelRow row{panel_of(&scene.truth, layer, scene.scale)};
  for (const std::string& method : methods)
    row.push_back(panel_of(maps_of(scene, method), layer, scene.scale));
  return row;
}

void add_row(PictureGrid& grid, const std::string& title, PanelRow row) {
  const bool nothing =
      std::all_of(row.begin(), row.end(), [](const Panel& panel) { return panel.empty(); });
  if (nothing) return;
  grid.row_titles.push_back(title);
  grid.rows.push_back(std::move(row));
}

constexpr MapId kImageAndSurface[] = {"rgb", "depth", "normal"};

std::string row_title(const FigureScene& scene, const MapRow& map) {
  return fmt::format("{}\n{}", scene.name, map.title);
}

void add_qualitative_rows(
    PictureGrid& grid, const FigureScene& scene, const PictureMethods& methods
) {
  const std::vector<Crop> crops = crops_of(scene, methods);
  std::vector<const FigureLayers*> columns{&scene.truth};
  for (const std::string& method : methods) columns.push_back(maps_of(scene, method));
  for (const MapId map : kImageAndSurface) {
    PanelRow whole, parts;
    for (const FigureLayers* maps : columns) {
      const Image picture = picture_of(maps, std::string(map.row().id), scene.scale);
      whole.push_back(outlined(picture, crops));
      parts.push_back(crop_panel(picture, crops));
    }
    add_row(grid, row_title(scene, map.row()), std::move(whole));
    add_row(grid, row_title(scene, map.row()) + ", crops", std::move(parts));
  }
}

struct FigureColumn {
  std::string title;
  std::string layer;
  bool truth = false;
  float gain = 1;
};

// The map, and behind it its truth where the table has one.
void add_columns(const MapRow& map, float gain, std::vector<FigureColumn>& columns) {
  const std::string id(map.id), title(map.title);
  const std::string times = gain == 1 ? "" : fmt::format(", x{:g}", gain);
  columns.push_back({title + times, id, false, gain});
  if (!map.truth.empty() || id == "rgb")
    columns.push_back({title + ", truth" + times, id, true, gain});
}

// Columns of the image and of every map of these kinds that one of the methods has rendered.
std::vector<FigureColumn> columns_of(
    const std::vector<FigureScene>& scenes, std::initializer_list<MapKind> kinds
) {
  std::vector<FigureColumn> columns;
  for (const MapRow& row : maps()) {
    const bool wanted = std::find(kinds.begin(), kinds.end(), row.kind) != kinds.end();
    if (wanted && !row.shown_file().empty() && !methods_with(scenes, std::string(row.id)).empty())
      add_columns(row, row.id == "reflected" ? kReflectedGain : 1, columns);
  }
  return columns;
}

Image brightened(Image picture, float gain) {
  for (float& value : picture.values()) value = std::min(gain * value, 1.0f);
  return picture;
}

// A row for every scene and method that has `needed`.
PictureGrid method_rows(
    const std::vector<FigureScene>& scenes,
    const std::vector<FigureColumn>& columns,
    const std::string& needed
) {
  PictureGrid grid;
  for (const FigureColumn& column : columns) grid.titles.push_back(column.title);
  for (const FigureScene& scene : scenes)
    for (const std::string& method : methods_with({scene}, needed)) {
      PanelRow row;
      for (const FigureColumn& column : columns)
        row.push_back(brightened(
            panel_of(
                column.truth ? &scene.truth : maps_of(scene, method), column.layer, scene.scale
            ),
            column.gain
        ));
      add_row(grid, fmt::format("{}\n{}", scene.name, method_title(method)), std::move(row));
    }
  return grid;
}

// Rows of the ablation table that any scene has, with their titles; the full model first.
std::vector<std::pair<std::string, std::string>> ablation_methods(
    const std::vector<FigureScene>& scenes
) {
  std::vector<std::pair<std::string, std::string>> methods;
  const auto rendered = methods_with(scenes, "rgb");
  for (const TableDefinition& definition : table_definitions())
    if (definition.paper_table == "3")
      for (const TableRowDefinition& row : definition.rows)
        if (rendered.count(row.method)) methods.emplace_back(row.method, row.title);
  if (!methods.empty()) std::rotate(methods.begin(), methods.end() - 1, methods.end());
  return methods;
}

}  // namespace

PictureGrid qualitative_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid;
  const auto methods = methods_with(scenes, "rgb");
  if (methods.empty()) return grid;
  grid.titles.emplace_back("truth");
  for (const std::string& method : methods) grid.titles.push_back(method_title(method));
  for (const FigureScene& scene : scenes) add_qualitative_rows(grid, scene, methods);
  grid.legend = legend_of(scenes, true);
  if (scenes.front().crops.empty())
    grid.legend.push_back(
        {"crops: where the methods together err most, on glass (orange) and off it (blue)"}
    );
  return grid;
}

PictureGrid depth_figure(const std::vector<FigureScene>& scenes) {
  std::vector<FigureColumn> columns{{"Image", "rgb"}};
  for (FigureColumn& column : columns_of(scenes, {MapKind::kDepth}))
    columns.push_back(std::move(column));
  PictureGrid grid = method_rows(scenes, columns, "behind_depth");
  grid.legend = legend_of(scenes, true);
  return grid;
}

PictureGrid transparency_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid;
  std::vector<std::pair<std::string, std::string>> panels;  // method, map
  std::vector<std::string> shares;
  grid.titles = {"image", "true glass"};
  for (const MapRow& row : maps()) {
    if (row.kind != MapKind::kShare) continue;
    const auto methods = methods_with(scenes, std::string(row.id));
    if (!methods.empty()) shares.emplace_back(row.title);
    for (const std::string& method : methods) {
      panels.emplace_back(method, row.id);
      grid.titles.push_back(fmt::format("{},\n{}", method_title(method), row.title));
    }
  }
  if (panels.empty()) return {};
  for (const FigureScene& scene : scenes) {
    PanelRow row{panel_of(&scene.truth, "rgb", scene.scale), mask_panel(scene.glass)};
    for (const auto& [method, map] : panels)
      row.push_back(panel_of(maps_of(scene, method), map, scene.scale));
    add_row(grid, scene.name, std::move(row));
  }
  grid.legend = legend_of(scenes, false);
  grid.legend.push_back({"true glass: white"});
  grid.legend.push_back(share_line(shares));
  return grid;
}

PictureGrid radiance_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid =
      method_rows(scenes, columns_of(scenes, {MapKind::kColor, MapKind::kPart}), "transmitted");
  grid.legend = legend_of(scenes, false);
  return grid;
}

PictureGrid ablation_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid;
  const auto rows = ablation_methods(scenes);
  if (rows.size() < 2) return grid;
  std::vector<std::string> methods;
  grid.titles.emplace_back("Truth");
  for (const auto& [method, title] : rows) {
    methods.push_back(method);
    grid.titles.push_back(title);
  }
  for (const FigureScene& scene : scenes) {
    for (const MapId map : kImageAndSurface)
      add_row(
          grid, row_title(scene, map.row()), layer_row(scene, methods, std::string(map.row().id))
      );
    PanelRow errors = layer_row(scene, methods, "error");
    errors[0] = mask_panel(scene.glass);
    add_row(grid, scene.name + "\nError; glass", std::move(errors));
  }
  grid.legend = legend_of(scenes, true);
  grid.legend.push_back(error_line());
  return grid;
}

}  // namespace glint
