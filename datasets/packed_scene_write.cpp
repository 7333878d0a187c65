// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>

#include "datasets/map_codes.h"
#include "datasets/packed_scene.h"
#include "datasets/packed_scene_format.h"
#include "datasets/view_maps.h"
#include "glint/core/config.h"
#include "glint/core/parallel.h"
#include "glint/scene/safetensors.h"

namespace glint {
namespace {

using packed::Split;

using Shape = std::vector<std::size_t>;

// Maps that are coded together.
struct MapGroup {
  std::string name;
  MapKind kind = MapKind::kColor;
  std::uint8_t present = 0;
  std::vector<const Image*> maps;
  std::string coded;
};

// Of all views, in the order of names.
std::vector<MapGroup> groups_of(const Scene& scene) {
  std::map<std::string, MapGroup> groups;
  for (const Split& split : packed::kSplits) {
    const std::vector<View>& views = scene.*split.views;
    for (std::size_t i = 0; i < views.size(); ++i)
      for_each_map(views[i], [&](const std::string& name, const Image& map, const MapRow& row) {
        if (map.empty()) return;
        const std::size_t place = i % packed::kViewsTogether;
        const std::string of = packed::maps_name(split.name, name, i / packed::kViewsTogether);
        MapGroup& group = groups[of];
        group.name = of;
        group.kind = row.kind;
        group.present = static_cast<std::uint8_t>(group.present | 1u << place);
        group.maps.push_back(&map);
      });
  }
  std::vector<MapGroup> list;
  for (auto& [name, group] : groups) list.push_back(std::move(group));
  return list;
}

std::vector<MapGroup> coded_maps(const Scene& scene) {
  std::vector<MapGroup> groups = groups_of(scene);
  parallel_for(groups.size(), 1, [&](std::size_t i) {
    MapGroup& group = groups[i];
    group.coded = static_cast<char>(group.present) + encode_maps(group.kind, group.maps);
  });
  return groups;
}

// Collects the tensors of a scene, which it borrows.
class Packer {
 public:
  explicit Packer(const Scene& scene) {
    for (const Split& split : packed::kSplits) add_cameras(split.name, scene.*split.views);
    for (MapGroup& group : coded_maps(scene)) add_text(group.name, std::move(group.coded));
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
  // Vectors [N][3], coded as a picture of one row.
  void add_points(const std::string& name, std::span<const Vec3f> points) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    const auto* first = reinterpret_cast<const float*>(points.data());
    Image row(static_cast<int>(points.size()), 1, 3);
    std::copy_n(first, 3 * points.size(), row.data());
    const Image* rows[] = {&row};
    const std::uint64_t count = points.size();
    std::string coded(reinterpret_cast<const char*>(&count), sizeof count);
    if (count > 0) coded += encode_maps(packed::kPointKind, rows);
    add_text(name, std::move(coded));
  }
  void add_text(const std::string& name, std::string text) {
    const Shape shape{text.size()};
    add(name, TensorType::kU8, shape, [text = std::move(text)](std::byte* to) {
      std::copy_n(reinterpret_cast<const std::byte*>(text.data()), text.size(), to);
    });
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
