// SPDX-License-Identifier: MIT
#include "reports/show/pictures/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/drawing/color_maps.h"
#include "glint/scene/image_files.h"
#include "metrics/components.h"
#include "metrics/normal.h"
#include "reports/run/records/run_folder.h"

namespace glint {

namespace {

constexpr int kColorSteps = 256;  // of the colour bars: those of the tables

Image error_map(const Image& render, const Image& truth) {
  Image error(truth.width(), truth.height(), 1);
  for (std::size_t i = 0; i < truth.num_pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float scored = std::clamp(render.values()[3 * i + c], 0.0f, 1.0f);
      error.values()[i] += std::abs(scored - truth.values()[3 * i + c]) / 3;
    }
  return error;
}

Image angle_map(const Image& normal, const Image& truth) {
  const auto degrees = normal_angles_deg(normal, truth);
  Image angles(truth.width(), truth.height(), 1);
  for (std::size_t i = 0; i < angles.num_pixels(); ++i)
    angles.values()[i] = degrees.values()[i] < 0 ? std::numeric_limits<float>::quiet_NaN()
                                                 : static_cast<float>(degrees.values()[i]);
  return angles;
}

LayerStyle style_of(MapKind kind) {
  switch (kind) {
    case MapKind::kDepth:
      return LayerStyle::kDepth;
    case MapKind::kNormal:
      return LayerStyle::kNormal;
    case MapKind::kShare:
    case MapKind::kMask:
      return LayerStyle::kShare;
    default:
      return LayerStyle::kPicture;
  }
}

// Empty where there is no file or none that can be read.
Image read_layer(const fs::path& view_folder, const MapRow& row) {
  try {
    const fs::path file = render_file(view_folder, row);
    return is_there(file) ? read_image(file, row.channels()) : Image();
  } catch (const Error& error) {
    log::warn(fmt::format("report: shown as missing: {}", error.what()));
    return {};
  }
}

// Maps of a view that are not empty and have its size.
class Collector {
 public:
  explicit Collector(ImageSize size) : size_(size) {}
  void add(std::string_view id, Image map) {
    if (size_ == ImageSize{}) size_ = map.size();
    if (!map.empty() && map.size() == size_) maps_.emplace(id, std::move(map));
  }
  LayerMaps take() { return std::move(maps_); }

 private:
  ImageSize size_;
  LayerMaps maps_;
};

std::string hex_color(const float* rgb) {
  const auto byte = [](float value) { return static_cast<int>(std::lround(value * 255)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(rgb[0]), byte(rgb[1]), byte(rgb[2]));
}

struct ColorRange {
  float low = 0, high = 1;
  const char* unit = "";
};

ColorRange range_of(LayerStyle style, const DepthScale& scale) {
  switch (style) {
    case LayerStyle::kDepth:
      return {scale.low, scale.high, "m"};
    case LayerStyle::kError:
      return {0, kPageErrorHigh, ""};
    case LayerStyle::kAngle:
      return {0, kPageAngleHigh, "°"};
    default:
      return {};
  }
}

const char* style_name(LayerStyle style) {
  switch (style) {
    case LayerStyle::kPicture:
      return "picture";
    case LayerStyle::kNormal:
      return "normal";
    case LayerStyle::kDepth:
      return "depth";
    default:
      return "scalar";
  }
}

// The colours that layer_picture() gives a ramp from low to high.
Json colors_of(const PageLayer& layer, const DepthScale& scale) {
  const ColorRange range = range_of(layer.style, scale);
  Image ramp(kColorSteps, 1, 1);
  for (int i = 0; i < kColorSteps; ++i)
    ramp.at(i, 0) = range.low + (range.high - range.low) * static_cast<float>(i) /
                                    static_cast<float>(kColorSteps - 1);
  if (layer.style == LayerStyle::kDepth) ramp.at(0, 0) = std::max(ramp.at(0, 0), 1e-6f);
  const Image colors = layer_picture(layer, ramp, scale);
  Json json = Json::array();
  for (int i = 0; i < kColorSteps; ++i) json.push_back(hex_color(colors.pixel(i, 0)));
  return json;
}

}  // namespace

PageLayer layer_of(const MapRow& row) {
  return {std::string(row.id), std::string(row.title), style_of(row.kind)};
}

std::vector<PageLayer> page_layers() {
  std::vector<PageLayer> layers;
  for (const MapRow& row : maps()) {
    if (!row.shown_file().empty()) layers.push_back(layer_of(row));
    if (row.id == "rgb") layers.push_back({"error", "Error", LayerStyle::kError});
    if (row.id == "normal") layers.push_back({"angle", "Angle error", LayerStyle::kAngle});
  }
  return layers;
}

void add_errors(const View& view, LayerMaps& maps) {
  const auto fitting = [&](const char* id, const Image& truth) -> const Image* {
    const auto map = maps.find(id);
    const bool fits = map != maps.end() && !truth.empty() && map->second.size() == truth.size();
    return fits ? &map->second : nullptr;
  };
  if (const Image* rgb = fitting("rgb", view.rgb)) maps["error"] = error_map(*rgb, view.rgb);
  const Image& true_normal = view.truth["normal"];
  if (const Image* normal = fitting("normal", true_normal))
    maps["angle"] = angle_map(*normal, true_normal);
}

LayerMaps rendered_layers(const fs::path& view_folder, const View* view) {
  Collector layers(view ? view->rgb.size() : ImageSize{});
  for (const MapRow& row : maps())
    if (!row.shown_file().empty()) layers.add(row.id, read_layer(view_folder, row));
  LayerMaps found = layers.take();
  if (view != nullptr) add_errors(*view, found);
  return found;
}

Image rendered_layer(const fs::path& view_folder, const std::string& id, const View& view) {
  if (id == "error" || id == "angle") {
    const bool error = id == "error";
    const Image map = rendered_layer(view_folder, error ? "rgb" : "normal", view);
    const Image& truth = error ? view.rgb : view.truth["normal"];
    if (map.empty() || truth.size() != map.size()) return {};
    return error ? error_map(map, truth) : angle_map(map, truth);
  }
  const MapRow* row = find_map(id);
  if (row == nullptr || row->shown_file().empty()) return {};
  Image map = read_layer(view_folder, *row);
  return map.size() == view.rgb.size() ? map : Image();
}

bool has_rendered_layer(const fs::path& view_folder, const std::string& id, const View& view) {
  if (id == "error") return has_rendered_layer(view_folder, "rgb", view);
  if (id == "angle")
    return !view.truth["normal"].empty() && has_rendered_layer(view_folder, "normal", view);
  const MapRow* row = find_map(id);
  return row != nullptr && !row->shown_file().empty() &&
         or_warn([&] { return is_there(render_file(view_folder, *row)); });
}

LayerMaps true_layers(const View& view) {
  Collector layers(view.rgb.size());
  layers.add("rgb", view.rgb);
  view.truth.for_each([&](const MapRow& row, const Image& map) {
    if (row.shown_file().empty()) return;
    layers.add(
        row.id,
        row.kind == MapKind::kPart ? displayed_part(view.rgb, views_of(view.truth), row) : map
    );
  });
  return layers.take();
}

Image layer_picture(const PageLayer& layer, const Image& map, const DepthScale& scale) {
  const ColorRange range = range_of(layer.style, scale);
  switch (layer.style) {
    case LayerStyle::kDepth:
      return colorize_depth(map, range.low, range.high);
    case LayerStyle::kNormal:
      return colorize_normal(map);
    case LayerStyle::kShare:
      return colorize_scalar(map, range.low, range.high, ScalarColors::kViridis);
    case LayerStyle::kError:
    case LayerStyle::kAngle:
      return colorize_scalar(map, range.low, range.high, ScalarColors::kMagma);
    case LayerStyle::kPicture:
      return map;
  }
  return map;
}

std::vector<MapRow> maps_in(const MapSet& maps) {
  std::vector<MapRow> rows;
  maps.for_each([&](const MapRow& row, const Image&) {
    if (row.shown) rows.push_back(row);
  });
  return rows;
}

Json layers_json(const std::vector<PageLayer>& layers, const DepthScale& scale) {
  Json json = Json::array();
  for (const PageLayer& layer : layers) {
    Json entry = {{"id", layer.id}, {"title", layer.title}, {"style", style_name(layer.style)}};
    if (layer.style != LayerStyle::kPicture && layer.style != LayerStyle::kNormal) {
      const ColorRange range = range_of(layer.style, scale);
      entry["low"] = range.low;
      entry["high"] = range.high;
      entry["unit"] = range.unit;
      if (layer.style != LayerStyle::kError)
        entry["decimals"] = layer.style == LayerStyle::kAngle ? 1 : 3;  // in the probe
      entry["colors"] = colors_of(layer, scale);
    }
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace glint
