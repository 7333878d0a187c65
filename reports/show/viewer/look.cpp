// SPDX-License-Identifier: MIT
#include "reports/show/viewer/look.h"

#include <cmath>
#include <numbers>

#include "glint/scene/camera_path_file.h"

namespace glint {

namespace {

constexpr double kMaxScale = 4, kMaxPixels = 4096;  // a side
constexpr std::size_t kMaxSets = 16;

// Null where it is not there, or `json` is no object.
Json member(const Json& json, const char* field) {
  return json.is_object() ? json.value(field, Json()) : Json();
}

// A number of an object within limits.
double number_in(const Json& json, const char* field, double low, double high) {
  const Json value = member(json, field);
  const bool fits = value.is_number() && value.get<double>() >= low && value.get<double>() <= high;
  GLINT_CHECK(
      fits, kUsage, "{}: {}, expected a number from {} to {}", field, value.dump(), low, high
  );
  return value.get<double>();
}

std::size_t index_in(const Json& json, const char* field, std::size_t count) {
  const double index = number_in(json, field, 0, static_cast<double>(count) - 1);
  GLINT_CHECK(index == std::floor(index), kUsage, "{}: {} is no index", field, index);
  return static_cast<std::size_t>(index);
}

Json list_of(const Json& json, const char* field, std::size_t least, std::size_t most) {
  Json list = member(json, field);
  const bool fits = list.is_array() && list.size() >= least && list.size() <= most;
  GLINT_CHECK(fits, kUsage, "{}: expected a list of {} to {}", field, least, most);
  return list;
}

Camera camera_of(const Json& json) {
  const Json size = list_of(json, "size", 2, 2);
  const auto side = [&](std::size_t i) {
    return static_cast<int>(number_in({{"size", size[i]}}, "size", 8, kMaxPixels));
  };
  Camera lens;
  lens.width = side(0), lens.height = side(1);
  const Json camera = member(json, "camera");
  const double fov = number_in(camera, "fov_x", 1, 170) * std::numbers::pi / 180;
  lens.fx = lens.fy = 0.5 * lens.width / std::tan(0.5 * fov);
  lens.cx = 0.5 * lens.width, lens.cy = 0.5 * lens.height;
  return camera_from_json({{"world_from_cam", member(camera, "world_from_cam")}}, lens, "camera");
}

LightScales scales_of(const Json& json) {
  LightScales scales;
  const auto read = [&](const char* field, float& scale) {
    if (!member(json, field).is_null())
      scale = static_cast<float>(number_in(json, field, 0, kMaxScale));
  };
  read("reflection", scales.reflection);
  read("transmission", scales.transmission);
  read("transparency", scales.transparency);
  return scales;
}

SurfelStyle style_of(const Json& style) {
  if (style == "image") return SurfelStyle::kImage;
  if (style == "discs") return SurfelStyle::kDiscs;
  GLINT_CHECK(
      style == "points", kUsage, "style: {}, expected image, discs or points", style.dump()
  );
  return SurfelStyle::kPoints;
}

std::vector<std::string> names_of(const Json& json) {
  std::vector<std::string> names;
  for (const Json& name : list_of(json, "hidden", 0, kMaxSets)) {
    GLINT_CHECK(name.is_string(), kUsage, "hidden: {}, expected a set's name", name.dump());
    names.push_back(name.get<std::string>());
  }
  return names;
}

CutPlane cut_of(const Json& json) {
  const Json normal = list_of(json, "normal", 3, 3);
  CutPlane cut;
  for (int i = 0; i < 3; ++i)
    cut.normal[i] =
        number_in({{"normal", normal[static_cast<std::size_t>(i)]}}, "normal", -1e3, 1e3);
  const double length = std::sqrt(length2(cut.normal));
  GLINT_CHECK(length > 0, kUsage, "normal: no direction");
  cut.normal = (1 / length) * cut.normal;
  cut.offset = number_in(json, "offset", -1e6, 1e6);
  return cut;
}

LookPane pane_of(const Json& json, const LookLimits& limits) {
  LookPane pane;
  pane.run = index_in(json, "run", limits.runs);
  const Json layer = member(json, "layer");
  GLINT_CHECK(layer.is_string(), kUsage, "layer: expected an id");
  pane.layer = layer.get<std::string>();
  return pane;
}

}  // namespace

ViewId view_id_from_json(const Json& json, const LookLimits& limits) {
  const Json split = member(json, "split");
  GLINT_CHECK(
      split == "train" || split == "test", kUsage, "split: {}, expected train or test", split.dump()
  );
  ViewId view{split == "test"};
  view.index = index_in(json, "index", view.test ? limits.test : limits.train);
  return view;
}

Look look_from_json(const Json& json, const LookLimits& limits) {
  Look look;
  look.serial = static_cast<std::uint64_t>(number_in(json, "serial", 1, 9e15));
  const auto given = [&](const char* field, auto&& read) {
    if (const Json value = member(json, field); !value.is_null()) read(value);
  };
  given("view", [&](const Json& value) { look.view = view_id_from_json(value, limits); });
  look.camera = camera_of(json);
  for (const Json& pane : list_of(json, "panes", 1, 2)) look.panes.push_back(pane_of(pane, limits));
  given("scales", [&](const Json& value) { look.scales = scales_of(value); });
  given("style", [&](const Json& value) { look.style = style_of(value); });
  if (!member(json, "hidden").is_null()) look.hidden = names_of(json);
  given("cut", [&](const Json& value) { look.cut = cut_of(value); });
  return look;
}

}  // namespace glint
