// SPDX-License-Identifier: MIT
#include "reports/figures/map_figures.h"

#include <algorithm>
#include <set>

#include "glint/scene/image_files.h"
#include "reports/tables.h"

namespace glint {

namespace {

constexpr int kCropParts = 3;   // a crop is this part of the picture's width and height
constexpr int kCropSteps = 12;  // places tried along each side
constexpr float kBoxColor[] = {1.0f, 0.75f, 0.0f};

const LayerMaps* maps_of(const FigureScene& scene, const std::string& method) {
  const auto it = scene.methods.find(method);
  return it == scene.methods.end() ? nullptr : &it->second;
}

bool has(const LayerMaps* maps, const std::string& id) { return maps && maps->count(id) > 0; }

// The layer's picture in its own size; empty where there is none.
Image picture_of(const LayerMaps* maps, const std::string& id, const DepthScale& scale) {
  if (!has(maps, id)) return {};
  const auto& layers = page_layers();
  const auto layer = std::find_if(layers.begin(), layers.end(), [&](const PageLayer& candidate) {
    return id == candidate.id;
  });
  return layer_picture(*layer, maps->at(id), scale);
}

Image panel_of(const LayerMaps* maps, const std::string& id, const DepthScale& scale) {
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

Image cropped(const Image& picture, const Crop& crop) {
  if (picture.empty()) return {};
  Image part(crop.width, crop.height, picture.channels());
  for (int y = 0; y < crop.height; ++y)
    std::copy_n(
        picture.pixel(crop.left, crop.top + y), crop.width * picture.channels(), part.pixel(0, y)
    );
  return part;
}

// Enlarged with the box, so that its line has one width in all panels.
Image boxed(const Image& picture, const Crop& crop) {
  if (picture.empty()) return {};
  Image panel = fit_panel(picture);
  const auto scaled = [&](int value) { return value * panel.width() / picture.width(); };
  const int left = scaled(crop.left), right = scaled(crop.left + crop.width) - 1;
  const int top = scaled(crop.top), bottom = scaled(crop.top + crop.height) - 1;
  const auto near_edge = [](int at, int low, int high) { return at < low + 2 || at > high - 2; };
  for (int y = top; y <= std::min(bottom, panel.height() - 1); ++y)
    for (int x = left; x <= right; ++x)
      if (near_edge(x, left, right) || near_edge(y, top, bottom))
        std::copy_n(kBoxColor, 3, panel.pixel(x, y));
  return panel;
}

// As large as a panel of the whole picture.
Image crop_panel(const Image& picture, const Crop& crop) {
  if (picture.empty()) return {};
  const ImageSize size = fit_panel(picture).size();
  return resize_image(cropped(picture, crop), size);
}

std::set<std::string> methods_with(
    const std::vector<FigureScene>& scenes, const std::string& layer, bool variants
) {
  std::set<std::string> methods;
  for (const FigureScene& scene : scenes)
    for (const auto& [method, maps] : scene.methods)
      if (has(&maps, layer) && (variants || method.find('/') == std::string::npos))
        methods.insert(method);
  return methods;
}

double window_error(const Image& error, const Crop& crop) {
  double sum = 0;
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x)
      sum += static_cast<double>(error.at(crop.left + x, crop.top + y));
  return sum;
}

Crop crop_of(const FigureScene& scene, const std::set<std::string>& methods) {
  std::vector<const Image*> errors;
  for (const std::string& method : methods)
    if (const LayerMaps* maps = maps_of(scene, method); has(maps, "error"))
      errors.push_back(&maps->at("error"));
  if (errors.empty()) {
    const Image& truth = scene.truth.at("render");
    return {
        0, 0, std::max(1, truth.width() / kCropParts), std::max(1, truth.height() / kCropParts)};
  }
  return crop_of_errors(errors);
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

LegendLine share_line() { return {"t: 0 (opaque)", LegendBar::kShare, "1 (transparent)"}; }

// A row of one layer: the truth, then every method.
std::vector<Image> layer_row(
    const FigureScene& scene, const std::vector<std::string>& methods, const std::string& layer
) {
  std::vector<Image> row{panel_of(&scene.truth, layer, scene.scale)};
  for (const std::string& method : methods)
    row.push_back(panel_of(maps_of(scene, method), layer, scene.scale));
  return row;
}

void add_row(PictureGrid& grid, const std::string& title, std::vector<Image> row) {
  const bool nothing =
      std::all_of(row.begin(), row.end(), [](const Image& panel) { return panel.empty(); });
  if (nothing) return;
  grid.row_titles.push_back(title);
  grid.rows.push_back(std::move(row));
}

void add_qualitative_rows(
    PictureGrid& grid, const FigureScene& scene, const std::set<std::string>& methods
) {
  const Crop crop = crop_of(scene, methods);
  std::vector<const LayerMaps*> columns{&scene.truth};
  for (const std::string& method : methods) columns.push_back(maps_of(scene, method));
  const std::pair<const char*, const char*> layers[] = {
      {"render", "image"}, {"depth", "depth"}, {"normal", "normal"}};
  for (const auto& [layer, title] : layers) {
    std::vector<Image> whole, crops;
    for (const LayerMaps* maps : columns) {
      const Image picture = picture_of(maps, layer, scene.scale);
      whole.push_back(boxed(picture, crop));
      crops.push_back(crop_panel(picture, crop));
    }
    add_row(grid, fmt::format("{}\n{}", scene.name, title), std::move(whole));
    add_row(grid, fmt::format("{}\n{}, crop", scene.name, title), std::move(crops));
  }
}

struct FigureColumn {
  const char* title;
  const char* layer;
  bool truth = false;
};

// A row for every scene and method that has `needed`.
PictureGrid method_rows(
    const std::vector<FigureScene>& scenes,
    const std::vector<FigureColumn>& columns,
    const std::string& needed
) {
  PictureGrid grid;
  for (const FigureColumn& column : columns) grid.titles.emplace_back(column.title);
  for (const FigureScene& scene : scenes)
    for (const std::string& method : methods_with({scene}, needed, false)) {
      std::vector<Image> row;
      for (const FigureColumn& column : columns)
        row.push_back(panel_of(
            column.truth ? &scene.truth : maps_of(scene, method), column.layer, scene.scale
        ));
      add_row(grid, fmt::format("{}\n{}", scene.name, method), std::move(row));
    }
  return grid;
}

// Rows of the ablation table that any scene has, with their titles; the full model first.
std::vector<std::pair<std::string, std::string>> ablation_methods(
    const std::vector<FigureScene>& scenes
) {
  std::vector<std::pair<std::string, std::string>> methods;
  const auto rendered = methods_with(scenes, "render", true);
  for (const TableDefinition& definition : table_definitions())
    if (definition.paper_table == "3")
      for (const TableRowDefinition& row : definition.rows)
        if (rendered.count(row.method)) methods.emplace_back(row.method, row.title);
  if (!methods.empty()) std::rotate(methods.begin(), methods.end() - 1, methods.end());
  return methods;
}

}  // namespace

Crop crop_of_errors(const std::vector<const Image*>& errors) {
  const int width = errors[0]->width(), height = errors[0]->height();
  Crop crop{0, 0, std::max(1, width / kCropParts), std::max(1, height / kCropParts)}, best = crop;
  double most = -1;
  for (int j = 0; j <= kCropSteps; ++j)
    for (int i = 0; i <= kCropSteps; ++i) {
      crop.left = (width - crop.width) * i / kCropSteps;
      crop.top = (height - crop.height) * j / kCropSteps;
      double error = 0;
      for (const Image* map : errors) error += window_error(*map, crop);
      if (error > most) best = crop;
      most = std::max(most, error);
    }
  return best;
}

PictureGrid qualitative_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid;
  const auto methods = methods_with(scenes, "render", false);
  if (methods.empty()) return grid;
  grid.titles.emplace_back("truth");
  grid.titles.insert(grid.titles.end(), methods.begin(), methods.end());
  for (const FigureScene& scene : scenes) add_qualitative_rows(grid, scene, methods);
  grid.legend = legend_of(scenes, true);
  grid.legend.push_back({"crop: the window in which the methods together have the largest error"});
  return grid;
}

PictureGrid depth_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid = method_rows(
      scenes,
      {{"image", "render"},
       {"interface depth", "depth"},
       {"true depth", "depth", true},
       {"transmission depth", "behind"},
       {"true depth behind", "behind", true}},
      "behind"
  );
  grid.legend = legend_of(scenes, true);
  return grid;
}

PictureGrid transparency_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid;
  const auto found = methods_with(scenes, "t", false);
  if (found.empty()) return grid;
  const std::vector<std::string> methods(found.begin(), found.end());
  grid.titles = {"image", "true glass"};
  for (const std::string& method : methods) grid.titles.push_back(method + ", t");
  for (const FigureScene& scene : scenes) {
    std::vector<Image> row = layer_row(scene, methods, "t");
    row[0] = panel_of(&scene.truth, "render", scene.scale);
    row.insert(row.begin() + 1, mask_panel(scene.glass));
    add_row(grid, scene.name, std::move(row));
  }
  grid.legend = legend_of(scenes, false);
  grid.legend.push_back(share_line());
  return grid;
}

PictureGrid radiance_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid = method_rows(
      scenes,
      {{"truth", "render", true},
       {"rendered", "render"},
       {"base", "base"},
       {"transmission", "transmission"},
       {"reflection", "reflection"},
       {"seen through glass", "through"},
       {"seen through, truth", "through", true},
       {"mirrored by glass", "mirrored"},
       {"mirrored, truth", "mirrored", true}},
      "through"
  );
  grid.legend = legend_of(scenes, false);
  return grid;
}

PictureGrid ablation_figure(const std::vector<FigureScene>& scenes) {
  PictureGrid grid;
  const auto rows = ablation_methods(scenes);
  if (rows.size() < 2) return grid;
  std::vector<std::string> methods;
  grid.titles.emplace_back("truth");
  for (const auto& [method, title] : rows) {
    methods.push_back(method);
    grid.titles.push_back(title);
  }
  for (const FigureScene& scene : scenes) {
    for (const auto& [layer, title] :
         {std::pair("render", "image"), std::pair("depth", "depth"), std::pair("normal", "normal")})
      add_row(grid, fmt::format("{}\n{}", scene.name, title), layer_row(scene, methods, layer));
    std::vector<Image> errors = layer_row(scene, methods, "error");
    errors[0] = mask_panel(scene.glass);
    add_row(grid, scene.name + "\nerror; glass", std::move(errors));
  }
  grid.legend = legend_of(scenes, true);
  grid.legend.push_back(error_line());
  return grid;
}

}  // namespace glint
