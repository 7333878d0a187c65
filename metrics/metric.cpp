// SPDX-License-Identifier: MIT
#include "metrics/metric.h"

#include <algorithm>

#include "glint/core/error.h"
#include "metrics/mesh/mesh_protocol.h"

namespace glint {
namespace {

// Pixels within `radius` (Chebyshev) of one where `mask` is set (`value` true) or not set: the
// largest value of a square window, rows first.
MaskImage dilate(MaskView mask, bool value, int radius) {
  MaskImage rows(mask.width, mask.height, 1), result(mask.width, mask.height, 1);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      const int last = std::min(mask.width - 1, x + radius);
      for (int i = std::max(0, x - radius); i <= last; ++i)
        if ((mask.at(i, y) != 0) == value) rows.at(x, y) = 255;
    }
  for (int y = 0; y < mask.height; ++y)
    for (int i = std::max(0, y - radius); i <= std::min(mask.height - 1, y + radius); ++i)
      for (int x = 0; x < mask.width; ++x) result.at(x, y) |= rows.at(x, i);
  return result;
}

MaskImage select_pixels(MaskView glass, bool value) {
  MaskImage result(glass.width, glass.height, 1);
  for (int y = 0; y < glass.height; ++y)
    for (int x = 0; x < glass.width; ++x)
      result.at(x, y) = (glass.at(x, y) != 0) == value ? 255 : 0;
  return result;
}

// Empty masks: all pixels.
MaskImage counted_part(MaskImage mask, MaskView counted) {
  if (counted.empty()) return mask;
  MaskImage part(counted.width, counted.height, 1);
  for (int y = 0; y < counted.height; ++y)
    for (int x = 0; x < counted.width; ++x)
      part.at(x, y) = counts(mask, x, y) && counts(counted, x, y) ? 255 : 0;
  return part;
}

// Empty: glass is not known, or all pixels count.
MaskImage counted_glass(const ViewPair& pair) {
  if (pair.glass.empty() || pair.counted.empty()) return {};
  return counted_part(glass_region(pair.glass), pair.counted);
}

std::string keyed(const std::string& id, const Region& region) {
  return region.name.empty() ? id : id + "@" + region.name;
}

}  // namespace

MaskImage glass_region(MaskView glass) { return select_pixels(glass, true); }
MaskImage opaque_region(MaskView glass) { return select_pixels(glass, false); }

MaskImage glass_border_region(MaskView glass, int radius_px) {
  MaskImage border = dilate(glass, true, radius_px);
  const MaskImage other = dilate(glass, false, radius_px);
  for (std::size_t i = 0; i < border.num_pixels(); ++i) border.data()[i] &= other.data()[i];
  return border;
}

std::vector<Region> evaluation_regions(MaskView glass, MaskView counted) {
  std::vector<Region> regions;
  regions.push_back({"", counted_part({}, counted)});
  if (glass.empty()) return regions;
  const auto add = [&](const char* name, MaskImage mask) {
    mask = counted_part(std::move(mask), counted);
    const auto values = mask.values();
    if (std::any_of(values.begin(), values.end(), [](unsigned char v) { return v != 0; }))
      regions.push_back({name, std::move(mask)});
  };
  add("glass", glass_region(glass));
  add("glass-border", glass_border_region(glass));
  add("opaque", opaque_region(glass));
  return regions;
}

void take_reference_where_uncounted(MaskView counted, ImageView reference, Image& prediction) {
  for (int y = 0; y < counted.height; ++y)
    for (int x = 0; x < counted.width; ++x)
      if (counted.at(x, y) == 0)
        std::copy_n(reference.pixel(x, y), reference.channels, prediction.pixel(x, y));
}

const std::vector<MetricFamily>& metric_families() {
  static const std::vector<MetricFamily> families = [] {
    std::vector<MetricFamily> all;
    for (const auto& [id, family] : Registry<MetricFamily>::all()) all.push_back(family);
    return all;
  }();
  return families;
}

const Metric* find_metric(const std::string& id) {
  for (const Metric& metric : mesh_metric_list())
    if (metric.id == id) return &metric;
  const std::string plain = id.substr(0, id.find('@'));
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics)
      if (metric.id == plain) return &metric;
  return nullptr;
}

std::map<std::string, double> evaluate_view(const ViewPair& pair) {
  std::map<std::string, double> scores;
  const std::vector<Region> regions = evaluation_regions(pair.glass, pair.counted);
  const MaskImage glass = counted_glass(pair);
  ViewPair counted_pair = pair;
  if (!glass.empty()) counted_pair.glass = glass;
  for (const MetricFamily& family : metric_families()) {
    const std::vector<MetricValues> values = family.evaluate(counted_pair, regions);
    for (std::size_t r = 0; r < values.size(); ++r)
      for (std::size_t m = 0; m < values[r].size(); ++m)
        if (values[r][m]) scores[keyed(family.metrics[m].id, regions[r])] = *values[r][m];
  }
  return scores;
}

Json metric_protocols() {
  Json protocols = Json::object();
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics) {
      protocols[metric.id] = metric.protocol;
      if (family.files) protocols[metric.id].update(family.files(metric).provenance);
    }
  return protocols;
}

std::map<std::string, std::string> missing_metrics() {
  std::map<std::string, std::string> missing;
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics)
      if (family.files)
        if (const std::string why = family.files(metric).missing; !why.empty())
          missing[metric.id] = why;
  return missing;
}

}  // namespace glint
