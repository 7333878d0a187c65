// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "datasets/packed_scene.h"
#include "datasets/packed_scene_format.h"
#include "datasets/view_maps.h"
#include "glint/core/config.h"
#include "glint/scene/safetensors.h"

namespace glint {
namespace {

using packed::Split;

using Shape = std::vector<std::size_t>;

// The step of 1 / max(T) next to a value in [0, 1].
template <class T>
T nearest_step(float value) {
  constexpr auto kMax = static_cast<float>(std::numeric_limits<T>::max());
  return static_cast<T>(std::nearbyint(std::clamp(value, 0.0f, 1.0f) * kMax));
}

// Are all values steps of T, bit for bit?
template <class T>
bool fits(std::span<const float> values) {
  constexpr auto kMax = static_cast<float>(std::numeric_limits<T>::max());
  return std::all_of(values.begin(), values.end(), [&](float value) {
    const float stored = static_cast<float>(nearest_step<T>(value)) / kMax;
    return stored == value && !std::signbit(value);  // -0 has no step
  });
}

template <class T>
void fill_steps(std::span<const float> values, std::byte* to) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const T step = nearest_step<T>(values[i]);
    std::memcpy(to + i * sizeof(T), &step, sizeof(T));
  }
}

TensorType smallest_type(std::span<const float> values) {
  if (fits<std::uint8_t>(values)) return TensorType::kU8;
  return fits<std::uint16_t>(values) ? TensorType::kU16 : TensorType::kF32;
}

void fill_map(std::span<const float> values, TensorType type, std::byte* to) {
  if (type == TensorType::kU8)
    fill_steps<std::uint8_t>(values, to);
  else if (type == TensorType::kU16)
    fill_steps<std::uint16_t>(values, to);
  else
    std::memcpy(to, values.data(), values.size_bytes());
}

// Collects the tensors of a scene, which it borrows.
class Packer {
 public:
  explicit Packer(const Scene& scene) {
    for (const Split& split : packed::kSplits) add_views(split.name, scene.*split.views);
    add_points("points.positions", scene.points.positions);
    add_points("points.colors", scene.points.colors);
    if (!scene.points.normals.empty()) add_points("points.normals", scene.points.normals);
    const Vec3f a = scene.bounds_min, b = scene.bounds_max;
    add_array<float>("bounds", {2, 3}, {a.x, a.y, a.z, b.x, b.y, b.z});
    add_array<float>("spatial_scale", {1}, {scene.spatial_scale});
  }
  const std::vector<TensorToWrite>& tensors() const { return tensors_; }

 private:
  using Fill = std::function<void(std::byte*)>;

  void add(const std::string& name, TensorType type, Shape shape, Fill fill) {
    TensorToWrite& tensor = tensors_.emplace_back();
    tensor.name = name;
    tensor.info.type = type;
    tensor.info.shape = std::move(shape);
    tensor.fill = std::move(fill);
  }
  template <class T>
  void add_array(const std::string& name, Shape shape, std::vector<T> values) {
    add(name, kTensorTypeOf<T>, std::move(shape), [values = std::move(values)](std::byte* to) {
      const auto* from = reinterpret_cast<const std::byte*>(values.data());
      std::copy_n(from, values.size() * sizeof(T), to);
    });
  }
  // Vectors [N][3], in 8 or 16 bits where that loses nothing.
  void add_points(const std::string& name, std::span<const Vec3f> points) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    const auto* first = reinterpret_cast<const float*>(points.data());
    add_floats(name, {points.size(), 3}, {first, 3 * points.size()});
  }
  void add_floats(const std::string& name, Shape shape, std::span<const float> values) {
    const TensorType type = smallest_type(values);
    add(name, type, std::move(shape), [values, type](std::byte* to) { fill_map(values, type, to); }
    );
  }
  void add_cameras(const std::string& split, const std::vector<View>& views) {
    std::vector<std::int32_t> sizes;
    std::vector<double> intrinsics, poses;
    for (const View& view : views) {
      const Camera& c = view.camera;
      sizes.insert(sizes.end(), {c.width, c.height});
      intrinsics.insert(intrinsics.end(), {c.fx, c.fy, c.cx, c.cy});
      for (int i = 0; i < 3; ++i) {
        const Vec3d& row = c.rotation_cam_from_world.rows[i];
        poses.insert(poses.end(), {row.x, row.y, row.z, c.translation_cam_from_world[i]});
      }
    }
    add_array(split + ".size", {views.size(), 2}, std::move(sizes));
    add_array(split + ".intrinsics", {views.size(), 4}, std::move(intrinsics));
    add_array(split + ".cam_from_world", {views.size(), 3, 4}, std::move(poses));
  }
  void add_views(const std::string& split, const std::vector<View>& views) {
    add_cameras(split, views);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const std::string prefix = packed::view_prefix(split, i);
      for_each_map(views[i], [&](const std::string& name, const Image& map, const MapRow&) {
        if (!map.empty()) add_floats(prefix + name, shape_of(map), map.values());
      });
    }
  }
  static Shape shape_of(const Image& image) {
    return {
        static_cast<std::size_t>(image.height()),
        static_cast<std::size_t>(image.width()),
        static_cast<std::size_t>(image.channels())};
  }

  std::vector<TensorToWrite> tensors_;
};

std::string names_of(const std::vector<View>& views) {
  Json names = Json::array();
  for (const View& view : views) names.push_back(view.name);
  return names.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

void write_packed_scene(const fs::path& file, const Scene& scene) {
  packed::check_scene(scene, file.string());
  std::map<std::string, std::string> metadata = {
      {"format", packed::kFormat},
      {"version", packed::kVersion},
      {"name", scene.name},
      {"dataset", scene.dataset},
      {"hash", scene.spec_hash},
      {"simulated_priors", scene.simulated_priors ? "true" : "false"}};
  if (!scene.data_notes.empty()) metadata["data_notes"] = Json(scene.data_notes).dump();
  for (const Split& split : packed::kSplits)
    metadata[std::string(split.name) + "_views"] = names_of(scene.*split.views);
  write_safetensors(file, metadata, Packer(scene).tensors());
}

}  // namespace glint
