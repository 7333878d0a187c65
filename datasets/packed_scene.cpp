// SPDX-License-Identifier: MIT
#include "datasets/packed_scene.h"

#include <algorithm>
#include <cmath>

#include "datasets/findings.h"
#include "datasets/packed_reader.h"
#include "datasets/view_maps.h"
#include "glint/core/config.h"
#include "glint/core/error.h"

namespace glint {
namespace {

using packed::Split;

constexpr int kMaxSide = 65535;  // pixels, as of image files

void read_cameras(packed::Reader& reader, const std::string& split, std::vector<View>& views) {
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

std::vector<View> read_views(packed::Reader& reader, const std::string& split) {
  std::vector<View> views;
  for (std::string& name : reader.list(split + "_views"))
    views.push_back({.name = std::move(name)});
  read_cameras(reader, split, views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string prefix = packed::view_prefix(split, i);
    // Before anything of the camera's size is allocated.
    check_camera(views[i].camera, reader.where() + ": " + prefix + "camera");
  }
  packed::read_maps(reader, split, views);
  return views;
}

void check_format(const packed::Reader& reader) {
  const std::string &format = reader.field("format"), &version = reader.field("version");
  GLINT_CHECK(
      format == packed::kFormat &&
          (version == packed::kVersion || version == packed::kFirstVersion),
      kBadReference,
      "{}: {} of version {}, expected {} of version {} or {}; pack the folder again",
      reader.where(),
      format,
      version,
      packed::kFormat,
      packed::kFirstVersion,
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
        shape_text(packed::shape_of(map.size(), map.channels())),
        shape_text(packed::shape_of(view.camera.size(), row.channels()))
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
  packed::Reader reader(file);
  check_format(reader);
  Scene scene;
  scene.name = reader.field("name");
  scene.dataset = reader.field("dataset");
  scene.spec_hash = reader.field("hash");
  scene.simulated_priors = reader.field("simulated_priors") == "true";
  if (reader.has_field("data_notes")) scene.data_notes = reader.list("data_notes");
  for (const Split& split : packed::kSplits) scene.*split.views = read_views(reader, split.name);
  scene.points = packed::read_points(reader);
  const std::vector<Vec3f> bounds = packed::read_vectors(reader, "bounds", 2);
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

Scene read_packed_scene(const fs::path& file) {
  return read_within_memory(file, [&] { return read_scene(file); });
}

}  // namespace glint
