// SPDX-License-Identifier: MIT
#include "datasets/glassroom/noise_floor.h"

#include <algorithm>
#include <cmath>

#include "glint/scene/image_files.h"

namespace glint {

namespace {

// Whether a map says anything at a pixel.
bool counts(MapId map, const PathTracerOutput& truth, int x, int y) {
  if (map == MapId("rgb")) return true;
  if (truth.maps["glass"].at(x, y) != 0) return true;
  const bool of_glass = map == MapId("transmitted") || map == MapId("reflected");
  return !of_glass && truth.maps["layer_1_mirror"].at(x, y) != 0;
}

// The displayed pixel's part that `part` has in its radiance `all`.
double displayed(float part, float all, float exposure) {
  if (!(all > 0)) return 0;
  const float shown = std::clamp(srgb_encode(all * exposure), 0.0f, 1.0f);
  return static_cast<double>(shown) * static_cast<double>(part / all);
}

}  // namespace

void NoiseFloor::add(const PathTracerOutput& truth, float exposure) {
  const auto& [first, second] = truth.halves;
  if (first.empty()) return;
  ++views_;
  const Image &all_a = first["rgb"], &all_b = second["rgb"];
  first.for_each([&](const MapRow& row, const Image& a) {
    const Image& b = second[row];
    sums_[row].resize(1);
    Sums& sums = sums_[row].front();
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x) {
        if (!counts(row, truth, x, y)) continue;
        for (int c = 0; c < 3; ++c) {
          const float va = a.at(x, y, c), vb = b.at(x, y, c);
          const double linear = 0.5 * static_cast<double>(exposure * (va - vb));
          const double shown = 0.5 * (displayed(va, all_a.at(x, y, c), exposure) -
                                      displayed(vb, all_b.at(x, y, c), exposure));
          sums.linear += linear * linear;
          sums.displayed += shown * shown;
          ++sums.count;
        }
      }
  });
}

Json NoiseFloor::json() const {
  if (views_ == 0) return {};
  Json json{{"views", views_}};
  sums_.for_each([&](const MapRow& row, const std::vector<Sums>& all) {
    const Sums& sums = all.front();
    if (sums.count == 0) return;
    const auto count = static_cast<double>(sums.count);
    Json& floor = json[std::string(row.id)];
    floor["standard_error"] = static_cast<float>(std::sqrt(sums.linear / count));
    if (sums.displayed > 0)
      floor["psnr"] = static_cast<float>(-10 * std::log10(sums.displayed / count));
  });
  return json;
}

}  // namespace glint
