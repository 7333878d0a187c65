// SPDX-License-Identifier: MIT
#include "datasets/glassroom/gltf_assets.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "datasets/glassroom/import_model.h"
#include "datasets/glassroom/write_scene.h"
#include "glint/core/error.h"
#include "glint/core/progress.h"

namespace glint {

namespace {

constexpr float kMaxSize = 2.4f;  // metres; anything larger is scaled down

struct KindName {
  const char* word;
  FurnitureKind kind;
};
// Longer words first where one contains another.
constexpr std::array<KindName, 10> kKindNames{{
    {"bookshelf", FurnitureKind::kBookshelf},
    {"armchair", FurnitureKind::kArmchair},
    {"wardrobe", FurnitureKind::kWardrobe},
    {"cabinet", FurnitureKind::kSideboard},
    {"stool", FurnitureKind::kStool},
    {"table", FurnitureKind::kDesk},
    {"plant", FurnitureKind::kPlant},
    {"desk", FurnitureKind::kDesk},
    {"sofa", FurnitureKind::kSofa},
    {"lamp", FurnitureKind::kFloorLamp},
}};

std::optional<FurnitureKind> kind_of(const fs::path& file) {
  const std::string name = file.stem().string();
  for (const KindName& entry : kKindNames)
    if (name.find(entry.word) != std::string::npos) return entry.kind;
  return std::nullopt;
}

// glTF has y up and its front along +z; furniture.h has z up and its front along +y.
Vec3f turned(Vec3f v) { return {-v.x, v.z, v.y}; }

Furniture read_asset(const fs::path& file, TraceScene& scene) {
  Furniture furniture = import_model(file, scene);
  for (FurniturePart& part : furniture) {
    for (Vec3f& vertex : part.mesh.vertices) vertex = turned(vertex);
    for (Vec3f& normal : part.mesh.normals) normal = turned(normal);
  }
  const Bounds bounds = bounds_of(furniture);
  const Vec3f size = bounds.size();
  const float scale = std::min(1.0f, kMaxSize / std::max({size.x, size.y, size.z}));
  const Vec3f origin{bounds.center().x, bounds.low.y, bounds.low.z};
  for (FurniturePart& part : furniture)
    for (Vec3f& vertex : part.mesh.vertices) vertex = scale * (vertex - origin);
  return furniture;
}

}  // namespace

AssetSource gltf_assets(const fs::path& folder) {
  std::vector<std::pair<FurnitureKind, fs::path>> files;
  for (const fs::path& file : list_files(folder, {".gltf", ".glb"})) {
    const auto kind = kind_of(file);
    const bool taken = kind && std::any_of(files.begin(), files.end(), [&](const auto& known) {
                         return known.first == *kind;
                       });
    if (kind && !taken)
      files.emplace_back(*kind, file);
    else
      log::info(fmt::format(
          "{}: not used ({})",
          file.string(),
          taken ? "a piece of that kind is there" : "no kind of furniture in its name"
      ));
  }
  return [files](TraceScene& scene) {
    std::vector<FurnitureAsset> assets;
    for (const auto& entry : files)
      assets.push_back({entry.first, read_asset(entry.second, scene)});
    return assets;
  };
}

std::string asset_hash(const fs::path& folder) {
  GLINT_CHECK(
      fs::is_directory(folder), kBadReference, "{}: no such folder of assets", folder.string()
  );
  return fmt::format("{:016x}", hash_name(file_hashes(folder).dump()));
}

}  // namespace glint
