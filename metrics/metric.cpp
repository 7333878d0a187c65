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

std::vector<Region> evaluation_regions(MaskView glass) {
  std::vector<Region> regions;
  regions.push_back({"", {}});
  if (glass.empty()) return regions;
  const auto add = [&](const char* name, MaskImage mask) {
    const auto values = mask.values();
    if (std::any_of(values.begin(), values.end(), [](unsigned char v) { return v != 0; }))
      regions.push_back({name, std::move(mask)});
  };
  add("glass", glass_region(glass));
  add("glass-border", glass_border_region(glass));
  add("opaque", opaque_region(glass));
  return regions;
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
  const std::vector<Region> regions = evaluation_regions(pair.glass);
  for (const MetricFamily& family : metric_families()) {
    const std::vector<MetricValues> values = family.evaluate(pair, regions);
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
