// SPDX-License-Identifier: MIT
#include "datasets/glassroom/write_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "datasets/glassroom/texture.h"
#include "datasets/map_files.h"
#include "datasets/opencv_yaml.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

Image scaled(ImageView image, float factor) {
  Image result(image.width, image.height, image.channels);
  for (std::size_t i = 0; i < result.values().size(); ++i)
    result.values()[i] = factor * image.data[i];
  return result;
}

// Radiance is multiplied by the exposure.
void write_truth(const fs::path& path, MapKind kind, const Image& map, float exposure) {
  write_true_map(path, kind, kind == MapKind::kPart ? scaled(map, exposure) : map);
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
  std::vector<std::string> names;
  for (std::size_t i = 0; i < cameras.size(); ++i) names.push_back(view_name(static_cast<int>(i)));
  write_opencv_cameras(folder, names, cameras);
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

std::set<std::string> files_below(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::path& file : list_files_below(folder))
    names.insert(file.lexically_relative(folder).generic_string());
  return names;
}

Json file_hashes(const fs::path& folder) {
  Json hashes = Json::object();
  for (const std::string& name : files_below(folder))
    hashes[name] = fmt::format("{:016x}", hash_name(read_file(folder / name)));
  return hashes;
}

}  // namespace glint
