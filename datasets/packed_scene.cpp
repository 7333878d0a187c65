// SPDX-License-Identifier: MIT
#include "datasets/packed_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "datasets/findings.h"
#include "datasets/packed_scene_format.h"
#include "datasets/view_maps.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/scene/safetensors.h"

namespace glint {
namespace {

using packed::Split;

constexpr int kMaxSide = 65535;  // pixels, as of image files

using Shape = std::vector<std::size_t>;

// The file, and which of its tensors were asked for.
class PackedReader {
 public:
  explicit PackedReader(const fs::path& path) : file_(path) {}

  std::string where() const { return file_.path().string(); }

  const std::string& field(const std::string& key) const {
    const auto it = file_.metadata().find(key);
    GLINT_CHECK(
        it != file_.metadata().end(),
        kBadReference,
        "{}: __metadata__ has no {}; expected a file that `glint-bench dataset pack` wrote",
        where(),
        key
    );
    return it->second;
  }
  bool has_field(const std::string& key) const { return file_.metadata().contains(key); }
  std::vector<std::string> list(const std::string& key) const {
    const Json json = parse_json(field(key));
    const bool good = json.is_array() && std::all_of(json.begin(), json.end(), [](const auto& v) {
                        return v.is_string();
                      });
    GLINT_CHECK(
        good, kBadReference, "{}: __metadata__: {} is no list of texts; pack it again", where(), key
    );
    return json.get<std::vector<std::string>>();
  }

  bool has(const std::string& name) const { return file_.find(name) != nullptr; }
  // The first extent of a tensor; 0 where there is none.
  std::size_t count(const std::string& name) const {
    const TensorInfo* info = file_.find(name);
    return info == nullptr || info->shape.empty() ? 0 : info->shape[0];
  }
  template <class T>
  std::vector<T> read(const std::string& name, const Shape& shape) {
    used_.insert(name);
    return file_.read<T>(name, shape);
  }
  // Floats, or integers over their maximum.
  std::vector<float> read_floats(const std::string& name, const Shape& shape) {
    const TensorInfo* info = file_.find(name);
    std::vector<float> values;
    if (info != nullptr && info->type == TensorType::kU8)
      values = steps<std::uint8_t>(name, shape);
    else if (info != nullptr && info->type == TensorType::kU16)
      values = steps<std::uint16_t>(name, shape);
    else
      values = read<float>(name, shape);
    return values;
  }
  void check_all_used() const {
    for (const std::string& name : file_.names())
      GLINT_CHECK(
          used_.contains(name),
          kBadReference,
          "{}: tensor {} has no place in a scene of version {}; pack it again",
          where(),
          name,
          packed::kVersion
      );
  }

 private:
  template <class T>
  std::vector<float> steps(const std::string& name, const Shape& shape) {
    constexpr auto kMax = static_cast<float>(std::numeric_limits<T>::max());
    std::vector<float> values;
    for (const T step : read<T>(name, shape)) values.push_back(static_cast<float>(step) / kMax);
    return values;
  }

  SafetensorsFile file_;
  std::set<std::string> used_;
};

Shape shape_of(ImageSize size, int channels) {
  return {
      static_cast<std::size_t>(size.height),
      static_cast<std::size_t>(size.width),
      static_cast<std::size_t>(channels)};
}

void read_cameras(PackedReader& reader, const std::string& split, std::vector<View>& views) {
  const auto sizes = reader.read<std::int32_t>(split + ".size", {views.size(), 2});
  const auto intrinsics = reader.read<double>(split + ".intrinsics", {views.size(), 4});
  const auto poses = reader.read<double>(split + ".cam_from_world", {views.size(), 3, 4});
  for (std::size_t i = 0; i < views.size(); ++i) {
    Camera& c = views[i].camera;
    c.width = sizes[2 * i], c.height = sizes[2 * i + 1];
    const double* k = &intrinsics[4 * i];
    c.fx = k[0], c.fy = k[1], c.cx = k[2], c.cy = k[3];
    const double* row = &poses[12 * i];
    for (int axis = 0; axis < 3; ++axis, row += 4) {
      c.rotation_cam_from_world.rows[axis] = {row[0], row[1], row[2]};
      c.translation_cam_from_world[axis] = row[3];
    }
  }
}

void check_camera(const Camera& camera, const std::string& where) {
  GLINT_CHECK(
      camera.width > 0 && camera.height > 0 && camera.width <= kMaxSide &&
          camera.height <= kMaxSide,
      kBadReference,
      "{}: {} x {} pixels, expected 1 to {} a side",
      where,
      camera.width,
      camera.height,
      kMaxSide
  );
  const std::optional<Finding> problem = camera_problem(camera, where);
  GLINT_CHECK(!problem, kBadReference, "{}: {}", where, problem->message);
}

void read_maps(PackedReader& reader, const std::string& prefix, View& view) {
  const ImageSize size = view.camera.size();
  for_each_map(view, [&](const std::string& name, Image& map, const MapRow& row) {
    if (!reader.has(prefix + name)) return;
    auto values = reader.read_floats(prefix + name, shape_of(size, row.channels()));
    if (row.kind == MapKind::kMask)
      for (float& value : values) value = value != 0 ? 1.0f : 0.0f;
    map = Image(size.width, size.height, row.channels());
    std::copy(values.begin(), values.end(), map.data());
  });
}

std::vector<View> read_views(PackedReader& reader, const std::string& split) {
  std::vector<View> views;
  for (std::string& name : reader.list(split + "_views"))
    views.push_back({.name = std::move(name)});
  read_cameras(reader, split, views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string prefix = packed::view_prefix(split, i);
    // Before anything of the camera's size is allocated.
    check_camera(views[i].camera, reader.where() + ": " + prefix + "camera");
    read_maps(reader, prefix, views[i]);
  }
  return views;
}

std::vector<Vec3f> read_vectors(PackedReader& reader, const std::string& name, std::size_t count) {
  const std::vector<float> values = reader.read_floats(name, {count, 3});
  std::vector<Vec3f> vectors(count);
  for (std::size_t i = 0; i < count; ++i)
    vectors[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return vectors;
}

PointCloud read_points(PackedReader& reader) {
  const std::size_t count = reader.count("points.positions");
  PointCloud points;
  points.positions = read_vectors(reader, "points.positions", count);
  points.colors = read_vectors(reader, "points.colors", count);
  if (reader.has("points.normals")) points.normals = read_vectors(reader, "points.normals", count);
  return points;
}

void check_format(const PackedReader& reader) {
  GLINT_CHECK(
      reader.field("format") == packed::kFormat && reader.field("version") == packed::kVersion,
      kBadReference,
      "{}: {} of version {}, expected {} of version {}; pack the folder again",
      reader.where(),
      reader.field("format"),
      reader.field("version"),
      packed::kFormat,
      packed::kVersion
  );
}

void check_finite(std::span<const float> values, const std::string& where) {
  const auto bad =
      std::find_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
  GLINT_CHECK(
      bad == values.end(),
      kBadReference,
      "{}: value {} is {}; store 0 where nothing is known",
      where,
      bad - values.begin(),
      *bad
  );
}

void check_view(const View& view, const std::string& where) {
  check_camera(view.camera, where + "camera");
  GLINT_CHECK(!view.rgb.empty(), kBadReference, "{}rgb is missing; pack it again", where);
  for_each_map(view, [&](const std::string& name, const Image& map, const MapRow& row) {
    if (map.empty()) return;
    const bool fits = map.size() == view.camera.size() && map.channels() == row.channels();
    GLINT_CHECK(
        fits,
        kBadReference,
        "{}{}: {}, expected {}",
        where,
        name,
        shape_text(shape_of(map.size(), map.channels())),
        shape_text(shape_of(view.camera.size(), row.channels()))
    );
    check_finite(map.values(), where + name);
  });
}

void check_vectors(std::span<const Vec3f> vectors, std::size_t count, const std::string& where) {
  GLINT_CHECK(
      vectors.size() == count,
      kBadReference,
      "{}: {} rows, expected {}",
      where,
      vectors.size(),
      count
  );
  check_finite({reinterpret_cast<const float*>(vectors.data()), 3 * count}, where);
}

// Results lie in folders of these names.
void check_names(const Scene& scene, const std::string& file) {
  const std::string why = why_no_folder_name(scene.name);
  GLINT_CHECK(
      why.empty(),
      kBadReference,
      "{}: __metadata__: name: '{}' {}; pack a folder with a plain name",
      file,
      scene.name,
      why
  );
  std::map<std::string, std::string> names;
  for (const Split& split : packed::kSplits)
    for (const View& view : scene.*split.views) {
      const std::string problem = view_name_problem(view.name, names);
      GLINT_CHECK(
          problem.empty(),
          kBadReference,
          "{}: __metadata__: {}_views: {}",
          file,
          split.name,
          problem
      );
    }
}

}  // namespace

void packed::check_scene(const Scene& scene, const std::string& file) {
  check_names(scene, file);
  GLINT_CHECK(!scene.train.empty(), kBadReference, "{}: no train views", file);
  for (const Split& split : kSplits)
    for (std::size_t i = 0; i < (scene.*split.views).size(); ++i)
      check_view((scene.*split.views)[i], file + ": " + view_prefix(split.name, i));
  const PointCloud& points = scene.points;
  const std::size_t count = points.positions.size();
  check_vectors(points.positions, count, file + ": points.positions");
  check_vectors(points.colors, count, file + ": points.colors");
  if (!points.normals.empty()) check_vectors(points.normals, count, file + ": points.normals");
  const Vec3f bounds[] = {scene.bounds_min, scene.bounds_max};
  check_vectors(bounds, 2, file + ": bounds");
  GLINT_CHECK(
      std::isfinite(scene.spatial_scale) && scene.spatial_scale > 0,
      kBadReference,
      "{}: spatial_scale is {}, expected a positive number",
      file,
      scene.spatial_scale
  );
}

namespace {

Scene read_scene(const fs::path& file) {
  PackedReader reader(file);
  check_format(reader);
  Scene scene;
  scene.name = reader.field("name");
  scene.dataset = reader.field("dataset");
  scene.spec_hash = reader.field("hash");
  scene.simulated_priors = reader.field("simulated_priors") == "true";
  if (reader.has_field("data_notes")) scene.data_notes = reader.list("data_notes");
  for (const Split& split : packed::kSplits) scene.*split.views = read_views(reader, split.name);
  scene.points = read_points(reader);
  const std::vector<Vec3f> bounds = read_vectors(reader, "bounds", 2);
  scene.bounds_min = bounds[0];
  scene.bounds_max = bounds[1];
  scene.spatial_scale = reader.read_floats("spatial_scale", {1})[0];
  reader.check_all_used();
  packed::check_scene(scene, file.string());
  return scene;
}

}  // namespace

bool is_packed_scene(const fs::path& file) {
  try {
    const SafetensorsFile tensors(file);
    const auto format = tensors.metadata().find("format");
    return format != tensors.metadata().end() && format->second == packed::kFormat;
  } catch (const Error&) {
    return false;
  }
}

void leave_out_train_truth(Scene& scene) {
  for (View& view : scene.train) {
    MapSet kept;
    if (view.truth.has("glass")) kept["glass"] = view.truth["glass"];
    view.truth = std::move(kept);
  }
}

Scene read_packed_scene(const fs::path& file) {
  return read_within_memory(file, [&] { return read_scene(file); });
}

}  // namespace glint
