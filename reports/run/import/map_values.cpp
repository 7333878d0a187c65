// SPDX-License-Identifier: MIT
#include "reports/run/import/map_values.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/middle.h"
#include "glint/core/vec.h"
#include "metrics/length_units.h"
#include "metrics/reduce.h"

namespace glint {
namespace {

bool is_depth(float z) { return std::isfinite(z) && z > 0; }

bool has_depth(const Image& map) {
  const auto values = map.values();
  return std::any_of(values.begin(), values.end(), is_depth);
}

std::vector<double> lengths_of(const Image& normals) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i < normals.num_pixels(); ++i) {
    const float* n = normals.data() + 3 * i;
    const double norm = static_cast<double>(length(Vec3f{n[0], n[1], n[2]}));
    if (std::isfinite(norm) && norm > 1e-6) lengths.push_back(norm);
  }
  return lengths;
}

std::string odd_depth(const Image& depth, const Image& truth) {
  if (!has_depth(truth)) return {};
  if (!has_depth(depth))
    return "no pixel has a finite depth above 0, so all of them count as missing";
  const double ratio = median_ratio(depth, truth);
  if (ratio == 0 || !is_odd_length_ratio(ratio)) return {};
  return fmt::format(
      "depth is {:.3g} times the true one (median) and is scored as metres; is it in {}, or "
      "disparity?",
      ratio,
      likely_unit(ratio)
  );
}

std::string odd_normals(const Image& normals, const Image& truth) {
  constexpr double kMostOff = 0.1;
  std::vector<double> lengths = lengths_of(normals);
  if (lengths.empty())
    return lengths_of(truth).empty()
               ? ""
               : "no pixel has a finite normal, so all of them count as missing";
  const double norm = median(lengths);
  if (std::abs(norm - 1) < kMostOff) return {};
  return fmt::format(
      "normals are {:.3g} long (median), expected 1, and are scored by their directions; are they "
      "vectors, not colours?",
      norm
  );
}

}  // namespace

std::string odd_values(MapKind kind, const Image& map, const Image& truth) {
  if (kind == MapKind::kDepth) return odd_depth(map, truth);
  return kind == MapKind::kNormal ? odd_normals(map, truth) : "";
}

void OddValues::look(
    const MapRow& row, const std::string& file, const Image& map, const Image& truth
) {
  const std::string odd = odd_values(row.kind, map, truth);
  if (odd.empty()) return;
  Found& found = found_[std::string(row.id)];
  if (found.num_views++ == 0) found.first = fmt::format("{}: {}", file, odd);
}

std::vector<std::string> OddValues::notes() const {
  std::vector<std::string> notes;
  for (const auto& [map, found] : found_)
    notes.push_back(
        found.num_views == 1
            ? found.first
            : fmt::format("{} ({} maps of {} are odd)", found.first, found.num_views, map)
    );
  return notes;
}

}  // namespace glint
