// SPDX-License-Identifier: MIT
#include "glint/scene/mesh_files.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {

std::string mesh_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

TriangleMesh read_mesh(const fs::path& path, NonFinite vertices) {
  const std::string extension = mesh_extension(path);
  if (extension == ".ply") return read_mesh_ply(path, vertices);
  GLINT_CHECK(
      std::ranges::count(kMeshExtensions, extension) > 0,
      kBadReference,
      "{}: '{}' files are not read; expected a mesh as {}",
      path.string(),
      extension,
      fmt::join(kMeshExtensions, ", ")
  );
  TriangleMesh mesh = read_within_memory(path, [&] { return read_model(path); });
  const auto finite = [](Vec3f v) { return std::isfinite(v.x + v.y + v.z); };
  GLINT_CHECK(
      vertices == NonFinite::kKeep || std::ranges::all_of(mesh.vertices, finite),
      kBadReference,
      "{}: a vertex is not finite; export it again",
      path.string()
  );
  return mesh;
}

void turn_back(TriangleMesh& mesh) {
  for (Vec3f& vertex : mesh.vertices) vertex = turned_back(vertex);
}

fs::path mesh_or_model(const fs::path& path) {
  if (is_file(path)) return path;
  for (const std::string& extension : kMeshExtensions)
    if (const fs::path other = fs::path(path).replace_extension(extension); is_file(other))
      return other;
  return path;
}

}  // namespace glint
