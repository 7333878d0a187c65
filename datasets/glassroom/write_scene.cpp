// SPDX-License-Identifier: MIT
#include "datasets/glassroom/write_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "datasets/glassroom/priors.h"
#include "datasets/glassroom/texture.h"
#include "glint/core/error.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr double kNear = 0.05, kFar = 20;  // metres, hints to loaders that ask for them

std::string yaml_matrix(
    const std::string& key, int rows, int cols, const std::vector<double>& data
) {
  std::string values;
  for (const double value : data)
    values += (values.empty() ? "" : ", ") + fmt::format("{:.17g}", value) +
              (value == std::floor(value) && std::abs(value) < 1e15 ? "." : "");
  return fmt::format(
      "{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
      key,
      rows,
      cols,
      values
  );
}

std::string yaml_head(std::size_t views) {
  std::string text = "%YAML:1.0\n---\nnames:\n";
  for (std::size_t i = 0; i < views; ++i)
    text += fmt::format("   - \"{}\"\n", view_name(static_cast<int>(i)));
  return text;
}

std::vector<double> flat(const Mat3d& m) {
  std::vector<double> values;
  for (const Vec3d& row : m.rows) values.insert(values.end(), {row.x, row.y, row.z});
  return values;
}

// Axis times angle.
Vec3d rodrigues(const Mat3d& rotation) {
  Vec4<double> q = quaternion_from_rotation(rotation);
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const Vec3d axis{q.x, q.y, q.z};
  const double sine = length(axis);
  return sine < 1e-12 ? Vec3d{} : (2 * std::atan2(sine, q.w) / sine) * axis;
}

std::string intrinsics_yaml(const std::vector<Camera>& cameras) {
  std::string text = yaml_head(cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera& c = cameras[i];
    const std::string name = view_name(static_cast<int>(i));
    text += yaml_matrix("K_" + name, 3, 3, {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1});
    text += fmt::format("H_{}: {}\nW_{}: {}\n", name, c.height, name, c.width);
    text += yaml_matrix("D_" + name, 5, 1, {0, 0, 0, 0, 0});
  }
  return text;
}

std::string extrinsics_yaml(const std::vector<Camera>& cameras) {
  std::string text = yaml_head(cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string name = view_name(static_cast<int>(i));
    const Vec3d r = rodrigues(cameras[i].rotation_cam_from_world);
    const Vec3d t = cameras[i].translation_cam_from_world;
    text += yaml_matrix("R_" + name, 3, 1, {r.x, r.y, r.z});
    text += yaml_matrix("Rot_" + name, 3, 3, flat(cameras[i].rotation_cam_from_world));
    text += yaml_matrix("T_" + name, 3, 1, {t.x, t.y, t.z});
    text += fmt::format("n_{}: {}\nf_{}: {:.1f}\n", name, kNear, name, kFar);
  }
  return text;
}

Image scaled(ImageView image, float factor) {
  Image result(image.width, image.height, image.channels);
  for (std::size_t i = 0; i < result.values().size(); ++i)
    result.values()[i] = factor * image.data[i];
  return result;
}

Image half_plus_half(ImageView normal) {
  Image result(normal.width, normal.height, 3);
  for (std::size_t i = 0; i < result.values().size(); ++i)
    result.values()[i] = 0.5f * normal.data[i] + 0.5f;
  return result;
}

void write_prior(const fs::path& path, MapKind kind, const Image& map) {
  if (kind == MapKind::kNormal) return write_png(path, half_plus_half(map));
  write_png(path, kind == MapKind::kDepth ? encode_depth(map) : map);
}

void write_truth(const fs::path& path, MapKind kind, const Image& map, float exposure) {
  if (kind == MapKind::kMask) return write_png(path, map);
  if (kind == MapKind::kPart) return write_exr(path, scaled(map, exposure));
  write_exr(path, map, kind == MapKind::kNormal);
}

Vec3f vertex_color(const TraceScene& scene, const TraceMesh& mesh, Vec2f uv) {
  const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
  Vec3f color = material.albedo;
  if (material.texture >= 0)
    color = hadamard(
        color,
        path_tracing::sample_texture(scene.textures[static_cast<std::size_t>(material.texture)], uv)
    );
  return {srgb_encode(color.x), srgb_encode(color.y), srgb_encode(color.z)};
}

// Splits every edge longer than the limit at its middle until none is left. Both faces at an edge
// split it alike, so the mesh stays conforming.
class Subdivision {
 public:
  Subdivision(const TraceScene& scene, const TraceMesh& mesh, float max_edge, TriangleMesh& out)
      : scene_(scene), mesh_(mesh), max_edge2_(max_edge * max_edge), out_(out) {
    first_ = static_cast<int>(out.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      add_vertex(mesh.vertices[i], mesh.uvs.empty() ? Vec2f{} : mesh.uvs[i]);
  }

  void split(int a, int b, int c) {
    const float ab = edge2(a, b), bc = edge2(b, c), ca = edge2(c, a);
    const float longest = std::max({ab, bc, ca});
    if (longest <= max_edge2_) {
      out_.faces.push_back({first_ + a, first_ + b, first_ + c});
    } else if (longest == ab) {
      const int m = middle(a, b);
      split(a, m, c), split(m, b, c);
    } else if (longest == bc) {
      split(b, c, a);
    } else {
      split(c, a, b);
    }
  }

 private:
  float edge2(int a, int b) const { return length2(position(a) - position(b)); }
  Vec3f position(int i) const { return out_.vertices[static_cast<std::size_t>(first_ + i)]; }
  int add_vertex(Vec3f position, Vec2f uv) {
    out_.vertices.push_back(position);
    out_.colors.push_back(vertex_color(scene_, mesh_, uv));
    uvs_.push_back(uv);
    return static_cast<int>(uvs_.size()) - 1;
  }
  int middle(int a, int b) {
    const auto key = std::minmax(a, b);
    const auto known = middles_.find(key);
    if (known != middles_.end()) return known->second;
    const Vec2f ua = uvs_[static_cast<std::size_t>(a)], ub = uvs_[static_cast<std::size_t>(b)];
    const int m = add_vertex(0.5f * (position(a) + position(b)), 0.5f * (ua + ub));
    middles_.emplace(key, m);
    return m;
  }

  const TraceScene& scene_;
  const TraceMesh& mesh_;
  float max_edge2_;
  TriangleMesh& out_;
  int first_ = 0;
  std::vector<Vec2f> uvs_;
  std::map<std::pair<int, int>, int> middles_;
};

}  // namespace

std::string view_name(int view) { return fmt::format("{:04}", view); }

Image display_image(ImageView radiance, float exposure) {
  Image image(radiance.width, radiance.height, 3);
  for (std::size_t i = 0; i < image.values().size(); ++i)
    image.values()[i] = std::clamp(srgb_encode(radiance.data[i] * exposure), 0.0f, 1.0f);
  return image;
}

void write_cameras(const fs::path& folder, const std::vector<Camera>& cameras) {
  write_file(folder / "intri.yml", intrinsics_yaml(cameras));
  write_file(folder / "extri.yml", extrinsics_yaml(cameras));
}

void write_view(
    const fs::path& folder,
    int view,
    const PathTracerOutput& truth,
    const MapSet& priors,
    float exposure
) {
  const std::string name = view_name(view);
  const fs::path frame = fs::path(name) / "000000.png", gt = folder / "gt";
  write_png(folder / "images" / frame, display_image(truth.radiance, exposure));
  priors.for_each([&](const MapRow& row, const Image& map) {
    write_prior(folder / "diffrens" / row.prior / frame, row.kind, map);
  });
  write_exr(gt / "rgb" / (name + ".exr"), scaled(truth.radiance, exposure));
  truth.maps.for_each([&](const MapRow& row, const Image& map) {
    if (!row.truth.empty()) write_truth(gt / true_map_file(row, name), row.kind, map, exposure);
  });
}

TriangleMesh truth_mesh(const TraceScene& scene, TruthLayer layer, float max_edge) {
  TriangleMesh result;
  for (const TraceMesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    if (layer == TruthLayer::kBehind && material.kind == MaterialKind::kThinDielectric) continue;
    Subdivision subdivision(scene, mesh, max_edge, result);
    for (const auto& face : mesh.faces) subdivision.split(face[0], face[1], face[2]);
  }
  return result;
}

Json file_hashes(const fs::path& folder) {
  std::vector<std::string> paths;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      paths.push_back(fs::relative(entry.path(), folder).generic_string());
  std::sort(paths.begin(), paths.end());
  Json hashes = Json::object();
  for (const std::string& path : paths)
    hashes[path] = fmt::format("{:016x}", hash_name(read_file(folder / path)));
  return hashes;
}

}  // namespace glint
