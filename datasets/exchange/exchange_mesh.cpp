// SPDX-License-Identifier: MIT
#include "datasets/exchange/exchange_mesh.h"

#include <fmt/format.h>

#include <iterator>

namespace glint {

namespace {

// What the numbers of faces count from: OBJ numbers a whole file, from 1.
struct ObjCounts {
  std::size_t vertices = 1, uvs = 1, normals = 1;
};

// "vertex/uv/normal"; absent ones are left out.
void add_corner(std::string& text, const TraceMesh& mesh, const ObjCounts& first, std::size_t i) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, " {}", first.vertices + i);
  if (mesh.uvs.empty() && mesh.normals.empty()) return;
  text += '/';
  if (!mesh.uvs.empty()) fmt::format_to(out, "{}", first.uvs + i);
  if (!mesh.normals.empty()) fmt::format_to(out, "/{}", first.normals + i);
}

// 9 digits: the same float again.
void add_mesh(std::string& text, const TraceMesh& mesh, std::size_t index, ObjCounts& first) {
  const auto out = std::back_inserter(text);
  const auto material = static_cast<std::size_t>(mesh.material);
  fmt::format_to(out, "# {}\no mesh_{}\n", mesh.name, index);
  for (const Vec3f& p : mesh.vertices)
    fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
  for (const Vec2f& uv : mesh.uvs) fmt::format_to(out, "vt {:.9g} {:.9g}\n", uv.x, 1 - uv.y);
  for (const Vec3f& n : mesh.normals)
    fmt::format_to(out, "vn {:.9g} {:.9g} {:.9g}\n", n.x, n.y, n.z);
  fmt::format_to(
      out, "usemtl {}\ns {}\n", exchange_material_id(material), mesh.normals.empty() ? 0 : 1
  );
  for (const auto& face : mesh.faces) {
    text += 'f';
    for (const std::int32_t i : face) add_corner(text, mesh, first, static_cast<std::size_t>(i));
    text += '\n';
  }
  first.vertices += mesh.vertices.size();
  first.uvs += mesh.uvs.size();
  first.normals += mesh.normals.size();
}

}  // namespace

std::string exchange_material_id(std::size_t material) {
  return fmt::format("material_{}", material);
}

std::string exchange_meshes(const TraceScene& scene) {
  std::string text = "# metres, z up\n";
  ObjCounts first;
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) add_mesh(text, scene.meshes[i], i, first);
  return text;
}

}  // namespace glint
