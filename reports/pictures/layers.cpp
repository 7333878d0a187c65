// SPDX-License-Identifier: MIT
#include "reports/pictures/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drawing/color_maps.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "metrics/components.h"
#include "metrics/normal.h"

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

// Empty where there is no file or none that can be read.
Image read_layer(const fs::path& file, int channels) {
  if (!fs::exists(file)) return {};
  try {
    return read_image(file, channels);
  } catch (const Error& error) {
    log::warn(fmt::format("report: shown as missing: {}", error.what()));
    return {};
  }
}

// Maps of a view that are not empty and have its size.
class Collector {
 public:
  explicit Collector(ImageSize size) : size_(size) {}
  void add(const std::string& id, Image map) {
    if (size_ == ImageSize{}) size_ = map.size();
    if (!map.empty() && map.size() == size_) maps_.emplace(id, std::move(map));
  }
  const Image* find(const std::string& id) const {
    const auto it = maps_.find(id);
    return it == maps_.end() ? nullptr : &it->second;
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

const std::vector<PageLayer>& page_layers() {
  static const std::vector<PageLayer> layers = {
      {"render", "Image", LayerStyle::kPicture, "rgb.exr"},
      {"error", "Error", LayerStyle::kError},
      {"depth", "Depth", LayerStyle::kDepth, "depth.exr", 1},
      {"normal", "Normal", LayerStyle::kNormal, "normal.exr"},
      {"angle", "Angle error", LayerStyle::kAngle},
      {"t", "Transparency t", LayerStyle::kShare, "transparency.exr", 1},
      {"k_s", "Specularity k_s", LayerStyle::kShare, "specularity.exr", 1},
      {"base", "Base", LayerStyle::kPicture, "interface.png"},
      {"transmission", "Transmission", LayerStyle::kPicture, "transmission.png"},
      {"reflection", "Reflection", LayerStyle::kPicture, "reflection.png"},
      {"behind", "Depth behind", LayerStyle::kDepth, "behind_depth.exr", 1},
      {"through", "Seen through", LayerStyle::kPicture, "transmitted.exr"},
      {"mirrored", "Mirrored", LayerStyle::kPicture, "reflected.exr"}};
  return layers;
}

LayerMaps rendered_layers(const fs::path& view_folder, const View* view) {
  Collector maps(view ? view->rgb.size() : ImageSize{});
  for (const PageLayer& layer : page_layers())
    if (layer.file != nullptr)
      maps.add(layer.id, read_layer(view_folder / layer.file, layer.channels));
  if (view == nullptr) return maps.take();
  if (const Image* render = maps.find("render")) maps.add("error", error_map(*render, view->rgb));
  const Image* normal = maps.find("normal");
  if (normal != nullptr && view->truth.normal.size() == normal->size())
    maps.add("angle", angle_map(*normal, view->truth.normal));
  return maps.take();
}

LayerMaps true_layers(const View& view) {
  const GroundTruth& truth = view.truth;
  Collector maps(view.rgb.size());
  maps.add("render", view.rgb);
  maps.add("depth", truth.depth);
  maps.add("normal", truth.normal);
  maps.add("behind", truth.behind_depth);
  if (!truth.transmitted.empty() && !truth.reflected.empty()) {
    maps.add("through", displayed_component(view.rgb, truth.transmitted, truth.reflected));
    maps.add("mirrored", displayed_component(view.rgb, truth.reflected, truth.transmitted));
  }
  return maps.take();
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

Json layers_json(const DepthScale& scale) {
  Json json = Json::array();
  for (const PageLayer& layer : page_layers()) {
    Json entry = {{"id", layer.id}, {"title", layer.title}, {"style", style_name(layer.style)}};
    if (layer.style != LayerStyle::kPicture && layer.style != LayerStyle::kNormal) {
      const ColorRange range = range_of(layer.style, scale);
      entry["low"] = range.low;
      entry["high"] = range.high;
      entry["unit"] = range.unit;
      entry["colors"] = colors_of(layer, scale);
    }
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace glint
