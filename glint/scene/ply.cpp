// SPDX-License-Identifier: MIT
#include "glint/scene/ply.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "glint/core/error.h"
#include "glint/scene/camera.h"
#include "glint/scene/ply_reader.h"

namespace glint {
namespace {

using detail::PlyElement;
using detail::PlyFile;
using detail::PlyProperty;
using detail::PlyType;

constexpr int kRestPerColor = kShCoefficients - 1;
const float kThirdScale = std::log(1e-6f);  // flat, but positive for viewers of ellipsoids

// ---------------------------------------------------------------- writing

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

void append(std::string& bytes, Vec3f v) {
  for (int i = 0; i < 3; ++i) append(bytes, v[i]);
}

void append_color(std::string& bytes, Vec3f color) {
  for (int i = 0; i < 3; ++i)
    append(
        bytes, static_cast<std::uint8_t>(std::nearbyint(std::clamp(color[i], 0.0f, 1.0f) * 255.0f))
    );
}

std::string header_of(std::size_t vertices, const std::vector<std::string>& floats) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  header += fmt::format("element vertex {}\n", vertices);
  for (const std::string& name : floats) header += fmt::format("property float {}\n", name);
  return header;
}

constexpr const char* kColorHeader =
    "property uchar red\nproperty uchar green\nproperty uchar blue\n";

std::vector<std::string> numbered(const std::string& stem, int count) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back(stem + std::to_string(i));
  return names;
}

// A cloud without them is written without their fields, which are most of a file.
bool has_rest(const SurfelCloud& cloud) { return cloud.size() == 0 || !cloud.sh_rest.empty(); }

std::vector<std::string> surfel_fields(const SurfelCloud& cloud) {
  std::vector<std::string> fields{"x", "y", "z", "nx", "ny", "nz"};
  const auto add = [&](const std::vector<std::string>& names) {
    fields.insert(fields.end(), names.begin(), names.end());
  };
  add(numbered("f_dc_", 3));
  if (has_rest(cloud)) add(numbered("f_rest_", 3 * kRestPerColor));
  add({"opacity"});
  add(numbered("scale_", 3));
  add(numbered("rot_", 4));
  add(cloud.extra_names);
  return fields;
}

// The surfel's normal: the third axis of its rotation; zero where the quaternion is.
Vec3f surfel_normal(const float* wxyz) {
  double norm2 = 0;
  for (int i = 0; i < 4; ++i) norm2 += static_cast<double>(wxyz[i]) * static_cast<double>(wxyz[i]);
  if (!(norm2 > 0)) return {};
  const double scale = 1 / std::sqrt(norm2);
  const Mat3d rotation = rotation_from_quaternion(
      {scale * static_cast<double>(wxyz[0]),
       scale * static_cast<double>(wxyz[1]),
       scale * static_cast<double>(wxyz[2]),
       scale * static_cast<double>(wxyz[3])}
  );
  return cast<float>(column(rotation, 2));
}

void append_surfel(std::string& bytes, const SurfelCloud& cloud, std::size_t i) {
  const auto append_row = [&](const FloatArray& array, std::size_t width) {
    for (std::size_t k = 0; k < width; ++k) append(bytes, array[i * width + k]);
  };
  append_row(cloud.means, 3);
  append(bytes, surfel_normal(&cloud.rotations[4 * i]));
  append_row(cloud.sh_dc, 3);
  for (std::size_t color = 0; has_rest(cloud) && color < 3; ++color)
    for (std::size_t k = 0; k < kRestPerColor; ++k)
      append(bytes, cloud.sh_rest[(i * kRestPerColor + k) * 3 + color]);
  append_row(cloud.opacity_logits, 1);
  append_row(cloud.log_scales, 2);
  append(bytes, kThirdScale);
  append_row(cloud.rotations, 4);
  append_row(cloud.extra_logits, cloud.num_extra());
}

// ---------------------------------------------------------------- reading

// Columns of the named scalars; an error lists every missing one.
std::vector<int> require_columns(
    const PlyFile& file, const PlyElement& element, const std::vector<std::string>& names
) {
  std::vector<int> columns;
  std::string missing;
  for (const std::string& name : names) {
    columns.push_back(element.find_scalar(name));
    if (columns.back() < 0) missing += " " + name;
  }
  GLINT_CHECK(
      missing.empty(),
      kBadReference,
      "{}: element {} lacks the properties{}",
      file.path,
      element.name,
      missing
  );
  return columns;
}

// One column of the file into one column of a parameter array. Errors: a value that is not finite.
void copy_column(
    const PlyFile& file,
    const PlyElement& element,
    const std::string& name,
    FloatArray& array,
    std::size_t width,
    std::size_t at
) {
  const int from = require_columns(file, element, {name})[0];
  for (std::size_t i = 0; i < element.count; ++i) {
    const float value = element.scalar(i, from);
    GLINT_CHECK(
        std::isfinite(value), kBadReference, "{}: surfel {}: {} is {}", file.path, i, name, value
    );
    array[i * width + at] = value;
  }
}

void copy_columns(
    const PlyFile& file,
    const PlyElement& element,
    const std::vector<std::string>& names,
    FloatArray& array
) {
  for (std::size_t at = 0; at < names.size(); ++at)
    copy_column(file, element, names[at], array, names.size(), at);
}

// f_rest_*: all of red, all of green, all of blue; 0, 3, 8 or 15 of each for SH degree 0 to 3.
void copy_sh_rest(const PlyFile& file, const PlyElement& element, SurfelCloud& cloud) {
  std::size_t count = 0;
  while (element.find_scalar(fmt::format("f_rest_{}", count)) >= 0) ++count;
  const auto named = std::count_if(
      element.properties.begin(),
      element.properties.end(),
      [](const PlyProperty& property) { return property.name.starts_with("f_rest_"); }
  );
  GLINT_CHECK(
      static_cast<std::size_t>(named) == count,
      kBadReference,
      "{}: {} properties f_rest_*, but no f_rest_{}; expected f_rest_0, f_rest_1, ... without a "
      "gap",
      file.path,
      named,
      count
  );
  GLINT_CHECK(
      count == 0 || count == 9 || count == 24 || count == 45,
      kBadReference,
      "{}: {} properties f_rest_*; expected 0, 9, 24 or 45 (SH degree 0 to 3)",
      file.path,
      count
  );
  const std::size_t per_color = count / 3;
  for (std::size_t k = 0; k < count; ++k)
    copy_column(
        file,
        element,
        fmt::format("f_rest_{}", k),
        cloud.sh_rest,
        3 * kRestPerColor,
        3 * (k % per_color) + k / per_color
    );
}

std::vector<std::string> extra_fields(const PlyElement& element) {
  const std::vector<std::string> known = surfel_fields({});
  std::vector<std::string> extra;
  for (const PlyProperty& property : element.properties) {
    const bool is_float = !property.is_list && (property.type == PlyType::kFloat32 ||
                                                property.type == PlyType::kFloat64);
    if (is_float && std::find(known.begin(), known.end(), property.name) == known.end())
      extra.push_back(property.name);
  }
  return extra;
}

// Beyond it a float has no decimetres left, and no scene reaches there.
constexpr float kFarthest = 1e6f;  // metres

void check_near(const PlyFile& file, const PlyElement& element, const std::vector<Vec3f>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      GLINT_CHECK(
          !std::isfinite(points[i][axis]) || std::abs(points[i][axis]) <= kFarthest,
          kBadReference,
          "{}: {} {}: {} is {:g}; expected metres within {:g} of the origin: the file is "
          "damaged, or in another unit",
          file.path,
          element.name,
          i,
          "xyz"[axis],
          points[i][axis],
          kFarthest
      );
}

std::vector<Vec3f> read_vectors(
    const PlyFile& file,
    const PlyElement& element,
    const std::vector<std::string>& names,
    NonFinite non_finite = NonFinite::kReject
) {
  const std::vector<int> columns = require_columns(file, element, names);
  std::vector<Vec3f> vectors(element.count);
  for (std::size_t i = 0; i < element.count; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const float value = element.scalar(i, columns[static_cast<std::size_t>(axis)]);
      GLINT_CHECK(
          std::isfinite(value) || non_finite == NonFinite::kKeep,
          kBadReference,
          "{}: {} {}: {} is {}",
          file.path,
          element.name,
          i,
          names[static_cast<std::size_t>(axis)],
          value
      );
      vectors[i][axis] = value;
    }
  return vectors;
}

// Colours as [0, 1]; empty when the file has none. Integers are divided by their maximum.
std::vector<Vec3f> read_colors(const PlyFile& file, const PlyElement& element) {
  if (element.find_scalar("red") < 0) return {};
  std::vector<Vec3f> colors = read_vectors(file, element, {"red", "green", "blue"});
  const auto red = std::find_if(
      element.properties.begin(),
      element.properties.end(),
      [](const PlyProperty& property) { return property.name == "red"; }
  );
  const float full_range = red->type == PlyType::kUint8    ? 255.0f
                           : red->type == PlyType::kUint16 ? 65535.0f
                                                           : 1.0f;
  for (Vec3f& color : colors)
    for (int axis = 0; axis < 3; ++axis) color[axis] /= full_range;
  return colors;
}

// Vertex indices of triangle `corner` of a polygon's fan, checked.
Triangle fan_triangle(
    const PlyFile& file,
    const PlyElement& faces,
    std::size_t begin,
    std::size_t corner,
    std::size_t vertices
) {
  Triangle triangle{};
  const std::size_t items[3] = {begin, begin + corner, begin + corner + 1};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t id = faces.list_items[items[k]];
    GLINT_CHECK(
        id >= 0 && id < static_cast<std::int64_t>(vertices),
        kBadReference,
        "{}: a face refers to vertex {}, the file has {}",
        file.path,
        id,
        vertices
    );
    triangle[k] = static_cast<std::int32_t>(id);
  }
  return triangle;
}

// Lists of faces may also be texture coordinates, say.
void check_lists_vertices(const PlyFile& file, const PlyElement& faces) {
  if (faces.count == 0) return;
  std::vector<std::string> found;
  for (const PlyProperty& property : faces.properties)
    if (property.is_list) found.push_back(property.name);
  GLINT_CHECK(
      std::ranges::any_of(
          found, [](const auto& name) { return name == "vertex_indices" || name == "vertex_index"; }
      ),
      kBadReference,
      "{}: faces need a list vertex_indices (or vertex_index) of their corners; found: {}",
      file.path,
      found.empty() ? "none" : fmt::format("{}", fmt::join(found, ", "))
  );
}

std::vector<Triangle> read_triangles(const PlyFile& file, std::size_t vertices) {
  const PlyElement& element = file.element("face");
  check_lists_vertices(file, element);
  std::vector<Triangle> triangles;
  triangles.reserve(element.count);
  std::size_t begin = 0;
  for (std::size_t i = 0; i < element.list_ends.size(); ++i) {
    const std::size_t corners = element.list_ends[i] - begin;
    GLINT_CHECK(corners >= 3, kBadReference, "{}: face {} has {} vertices", file.path, i, corners);
    for (std::size_t corner = 1; corner + 1 < corners; ++corner)
      triangles.push_back(fan_triangle(file, element, begin, corner, vertices));
    begin = element.list_ends[i];
  }
  return triangles;
}

}  // namespace

void write_surfel_ply(const fs::path& path, const SurfelCloud& cloud) {
  std::string bytes = header_of(cloud.size(), surfel_fields(cloud)) + "end_header\n";
  for (std::size_t i = 0; i < cloud.size(); ++i) append_surfel(bytes, cloud, i);
  write_file(path, bytes);
}

SurfelCloud read_surfel_ply(const fs::path& path) {
  const PlyFile file = detail::read_ply(path);
  const PlyElement& vertices = file.element("vertex");
  SurfelCloud cloud;
  cloud.extra_names = extra_fields(vertices);
  cloud.resize(vertices.count);
  copy_columns(file, vertices, {"x", "y", "z"}, cloud.means);
  copy_columns(file, vertices, numbered("f_dc_", 3), cloud.sh_dc);
  copy_sh_rest(file, vertices, cloud);
  copy_columns(file, vertices, {"opacity"}, cloud.opacity_logits);
  copy_columns(file, vertices, numbered("scale_", 2), cloud.log_scales);
  copy_columns(file, vertices, numbered("rot_", 4), cloud.rotations);
  copy_columns(file, vertices, cloud.extra_names, cloud.extra_logits);
  return cloud;
}

void write_point_ply(const fs::path& path, const PointCloud& points) {
  std::vector<std::string> fields{"x", "y", "z"};
  const bool has_normals = !points.normals.empty();
  if (has_normals) fields.insert(fields.end(), {"nx", "ny", "nz"});
  std::string bytes = header_of(points.positions.size(), fields) + kColorHeader + "end_header\n";
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    append(bytes, points.positions[i]);
    if (has_normals) append(bytes, points.normals[i]);
    append_color(bytes, points.colors[i]);
  }
  write_file(path, bytes);
}

PointCloud read_point_ply(const fs::path& path) {
  const PlyFile file = detail::read_ply(path);
  const PlyElement& vertices = file.element("vertex");
  PointCloud points;
  points.positions = read_vectors(file, vertices, {"x", "y", "z"});
  check_near(file, vertices, points.positions);
  points.colors = read_colors(file, vertices);
  if (points.colors.empty()) points.colors.assign(vertices.count, Vec3f{0.5f, 0.5f, 0.5f});
  if (vertices.find_scalar("nx") >= 0)
    points.normals = read_vectors(file, vertices, {"nx", "ny", "nz"});
  return points;
}

void write_mesh_ply(const fs::path& path, const TriangleMesh& mesh) {
  std::string bytes = header_of(mesh.vertices.size(), {"x", "y", "z"});
  if (!mesh.colors.empty()) bytes += kColorHeader;
  bytes += fmt::format(
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.faces.size()
  );
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    append(bytes, mesh.vertices[i]);
    if (!mesh.colors.empty()) append_color(bytes, mesh.colors[i]);
  }
  for (const auto& face : mesh.faces) {
    append(bytes, std::uint8_t{3});
    for (const std::int32_t id : face) append(bytes, id);
  }
  write_file(path, bytes);
}

TriangleMesh read_mesh_ply(const fs::path& path, NonFinite non_finite) {
  const PlyFile file = detail::read_ply(path);
  const PlyElement& vertices = file.element("vertex");
  GLINT_CHECK(
      vertices.count <= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()),
      kBadReference,
      "{}: {} vertices, expected fewer than 2^31",
      file.path,
      vertices.count
  );
  TriangleMesh mesh;
  mesh.vertices = read_vectors(file, vertices, {"x", "y", "z"}, non_finite);
  check_near(file, vertices, mesh.vertices);
  mesh.colors = read_colors(file, vertices);
  mesh.faces = read_triangles(file, vertices.count);
  return mesh;
}

bool is_mesh_ply(const fs::path& path) {
  const std::vector<std::string> names = detail::read_ply_element_names(path);
  return std::find(names.begin(), names.end(), "face") != names.end();
}

}  // namespace glint
