// SPDX-License-Identifier: MIT
#include "datasets/prior_maps.h"

#include <algorithm>
#include <cmath>

#include "datasets/map_files.h"
#include "datasets/map_resize.h"
#include "datasets/prior_codes.h"
#include "glint/core/error.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

Image read_finite(const fs::path& path, int channels) {
  Image map = read_image(path, channels);
  check_finite(path, map);
  return map;
}

// `normal`: n, or with `encoded` (n + 1) / 2.
void decode_normals(Image& normal, bool encoded) {
  for (std::size_t i = 0; i < normal.num_pixels(); ++i) {
    float* n = normal.data() + 3 * i;
    const Vec3f stored{n[0], n[1], n[2]};
    const Vec3f unit = encoded ? decode_normal(stored) : unit_normal(stored);
    for (int c = 0; c < 3; ++c) n[c] = unit[c];
  }
}

Image read_normal_prior(const fs::path& path) {
  Image normal = read_finite(path, 3);
  decode_normals(normal, true);
  return normal;
}

Image read_depth_prior(const fs::path& path) {
  Image stored = read_image(path);
  if (stored.channels() == 1) return read_finite(path, 1);
  Image depth(stored.width(), stored.height(), 1);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i) {
    const float* rgb = stored.data() + 3 * i;
    depth.data()[i] = decode_depth(rgb[0], rgb[1], rgb[2]);
  }
  return depth;
}

Image mean_of_channels(const Image& map) {
  const auto channels = static_cast<std::size_t>(map.channels());
  Image mean(map.width(), map.height(), 1);
  for (std::size_t i = 0; i < mean.num_pixels(); ++i) {
    for (std::size_t c = 0; c < channels; ++c) mean.data()[i] += map.data()[channels * i + c];
    mean.data()[i] /= static_cast<float>(channels);
  }
  return mean;
}

bool has_negative(const Image& map) {
  constexpr float kNegative = -0.001f;
  return std::any_of(map.values().begin(), map.values().end(), [](float value) {
    return value < kNegative;
  });
}

Image read_foreign_prior(const fs::path& path, MapKind kind) {
  if (kind == MapKind::kDepth) {
    const Image map = read_image(path);
    check_finite(path, map);
    return mean_of_channels(map);
  }
  Image map = read_finite(path, channels_of(kind));
  if (kind == MapKind::kNormal) decode_normals(map, !has_negative(map));
  return map;
}

// Base colour x (1 - metallic), pixel by pixel.
Image albedo_of(Image basecolor, const fs::path& metallic_file) {
  const Image metallic =
      resize_prior(mean_of_channels(read_image(metallic_file)), MapKind::kShare, basecolor.size());
  for (std::size_t i = 0; i < basecolor.num_pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      basecolor.data()[3 * i + c] *= 1 - std::clamp(metallic.data()[i], 0.0f, 1.0f);
  return basecolor;
}

void convert_depth(const PriorReading& reading, Image& depth) {
  constexpr float kFarthest = 50;  // in units of the nearest, of disparities
  if (reading.depth == PriorDepth::kLinear) return;
  const bool inverted = reading.depth == PriorDepth::kInverted;
  const float shift = inverted ? 0 : reading.disparity_shift;
  const float largest = shift + *std::max_element(depth.values().begin(), depth.values().end());
  if (!(largest > 0)) return;
  for (float& value : depth.values()) {
    if (!(value > 0)) continue;
    const float share = (value + shift) / largest;
    // Affine maps change nothing: losses fit scale and shift. The nearest stays above 0, "nothing".
    value = inverted ? 1 - share + 1.0f / 1024 : 1 / (kFarthest * std::max(share, 1 / kFarthest));
  }
}

}  // namespace

Image read_prior(const fs::path& path, MapKind kind) {
  if (kind == MapKind::kNormal) return read_normal_prior(path);
  if (kind == MapKind::kDepth) return read_depth_prior(path);
  return read_true_map(path, kind);
}

Image read_stored_prior(const ViewSource& view, const MapRow& row) {
  const fs::path& path = view.priors[row];
  Image map = view.prior_programs.has(row) ? read_foreign_prior(path, row.kind)
                                           : read_prior(path, row.kind);
  const bool made = row.id == "albedo" && path == view.priors["basecolor"];
  return made && !view.metallic.empty() ? albedo_of(std::move(map), view.metallic) : std::move(map);
}

Image resize_prior(Image map, MapKind kind, ImageSize size) {
  if (map.size() == size) return map;
  if (kind == MapKind::kNormal) return resize_normal(map, size);
  if (kind != MapKind::kDepth) return resize_image(map, size);
  Image valid(map.width(), map.height(), 1);
  for (std::size_t i = 0; i < map.num_pixels(); ++i) valid.data()[i] = map.data()[i] > 0 ? 1 : 0;
  Image depth = resize_image(map, size);
  const Image share = resize_image(valid, size);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    depth.data()[i] = share.data()[i] < 0.5f ? 0 : depth.data()[i] / share.data()[i];
  return depth;
}

Vec3d normal_in_cam(Vec3d stored, PriorAxes axes, const Camera& camera) {
  switch (axes) {
    case PriorAxes::kOpengl:
      return {stored.x, -stored.y, -stored.z};
    case PriorAxes::kStableNormal:
      return -stored;
    case PriorAxes::kWorld:
      return camera.rotation_cam_from_world * stored;
    case PriorAxes::kOpencv:
      break;
  }
  return stored;
}

void convert_prior(MapKind kind, const PriorReading& reading, const Camera& camera, Image& map) {
  if (kind == MapKind::kDepth) convert_depth(reading, map);
  if (kind != MapKind::kNormal || reading.axes == PriorAxes::kOpencv) return;
  for (std::size_t i = 0; i < map.num_pixels(); ++i) {
    float* n = map.data() + 3 * i;
    const Vec3f turned = cast<float>(normal_in_cam({n[0], n[1], n[2]}, reading.axes, camera));
    for (int c = 0; c < 3; ++c) n[c] = turned[c];
  }
}

}  // namespace glint
