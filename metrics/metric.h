// SPDX-License-Identifier: MIT
// Metrics of one rendered view, their registry, and the image regions each is given for. A metric
// is a pure function in a file of its own (psnr.h, ssim.h, depth.h, ...); a family in view/ gives
// it ids, units and a protocol and registers them: adding a metric is adding a file there.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/image.h"
#include "glint/core/registry.h"
#include "glint/scene/maps.h"

namespace glint {

// Pixels that count. An empty mask means all.
inline bool counts(MaskView mask, int x, int y) { return mask.empty() || mask.at(x, y) != 0; }

// Region masks from the ground-truth glass mask: "glass", "glass-border" (`radius_px` to either
// side of the outline, Chebyshev distance; the image's edge is no outline), "opaque" (not glass).
// Each has the size of `glass`.
MaskImage glass_region(MaskView glass);
MaskImage glass_border_region(MaskView glass, int radius_px = 3);
MaskImage opaque_region(MaskView glass);

struct Region {
  std::string name;  // empty: the whole image
  MaskImage mask;    // empty: the whole image
};
// The whole image, then the three above that have a pixel; without a glass mask the whole image
// alone. Of each the pixels that count, where not all do.
std::vector<Region> evaluation_regions(MaskView glass, MaskView counted = {});

// Where a pixel does not count, the prediction is right: metrics with windows look at it.
void take_reference_where_uncounted(MaskView counted, ImageView reference, Image& prediction);

// What a method rendered and what is true, all of one size.
struct ViewPair {
  MapViews rendered;  // rgb is not clamped; depth and normal: 0 or not finite where nothing is
  MapViews truth;     // "rgb" is the view's image
  MaskView glass;     // non-zero: the first surface is glass; empty: not known
  MaskView counted;   // non-zero: the pixel counts; empty: all do

  // The rendered map, or `instead` of a method that renders none.
  ImageView rendered_or(MapId map, MapId instead) const {
    return rendered[rendered[map].empty() ? instead : map];
  }
};

enum class Direction { kHigherIsBetter, kLowerIsBetter };
NLOHMANN_JSON_SERIALIZE_ENUM(
    Direction, {{Direction::kHigherIsBetter, "higher"}, {Direction::kLowerIsBetter, "lower"}}
)

struct Metric {
  std::string id;    // "psnr", "normal-11.25", ...: docs/reference/metrics.md
  std::string unit;  // "dB", "deg", "%", "m", "" for plain numbers
  Direction direction = Direction::kHigherIsBetter;
  int decimals = 3;  // as printed in tables; JSON is never rounded
  Json protocol;     // every constant that the value depends on
};

// One value per metric of a family, empty where a view has nothing to score.
using MetricValues = std::vector<std::optional<double>>;

// What a metric has from files of the user, such as the weights of a network.
struct MetricFiles {
  std::string missing;               // why there is no value here ("no weights"); empty: there is
  Json provenance = Json::object();  // recorded with the protocol
};

// Metrics that come out of one pass over the maps.
struct MetricFamily {
  std::vector<Metric> metrics;
  // One entry per region, in their order, or one of the whole image alone; none where the view
  // lacks a map. Errors: those of the metric's function.
  std::function<std::vector<MetricValues>(const ViewPair&, std::span<const Region>)> evaluate;
  std::function<MetricFiles(const Metric&)> files = nullptr;  // null: it needs none
};

inline const std::string& registry_id(const MetricFamily& family) {
  return family.metrics.front().id;
}
// Registered with GLINT_REGISTER(MetricFamily, ...): all families, in the order of their first ids.
const std::vector<MetricFamily>& metric_families();

// nullptr: unknown. Metrics of meshes go by their whole id ("mesh-f1@5cm", mesh/mesh_protocol.h);
// behind another's '@' stands a region ("psnr@glass").
const Metric* find_metric(const std::string& id);

// Every registered metric of a view, by id ("psnr") and, for regions, "psnr@glass". What cannot be
// scored (map not rendered, no truth, no such pixels) is absent. Errors: kBadPrediction and
// kBadReference for maps of another size and colours that are not finite.
std::map<std::string, double> evaluate_view(const ViewPair& pair);

// {"psnr": {...}, ...}: the protocol behind each id, with the provenance of its files.
Json metric_protocols();

// Metrics that no view of this machine can have, each with why: {"lpips-vgg": "no weights"}.
std::map<std::string, std::string> missing_metrics();

}  // namespace glint
