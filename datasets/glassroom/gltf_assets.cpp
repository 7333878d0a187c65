// SPDX-License-Identifier: MIT
#include "datasets/glassroom/gltf_assets.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "datasets/glassroom/write_scene.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr int kMaxTexture = 512;  // pixels; larger textures are area averaged
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

// The JSON of a .gltf, or of a .glb's first chunk: magic, version, length; length, type, bytes.
std::string_view gltf_json(std::string_view bytes) {
  constexpr std::size_t kLengthAt = 12, kJsonAt = 20;
  if (!bytes.starts_with("glTF") || bytes.size() < kJsonAt) return bytes;
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + kLengthAt, sizeof length);
  return bytes.substr(kJsonAt, length);
}

// assimp tries its readers of forty other formats on what is no glTF, and calls itself for every
// level of JSON.
void check_gltf(const fs::path& file) {
  const std::string bytes = read_file(file);
  const Json json = parse_json(gltf_json(bytes));
  const Json asset = json.is_object() ? json.value("asset", Json()) : Json();
  const Json version = asset.is_object() ? asset.value("version", Json()) : Json();
  GLINT_CHECK(
      version.is_string() && version.get<std::string>().starts_with("2"),
      kBadReference,
      "{}: no glTF 2.0 (asset.version is {}), or nested more than {} deep; export it again",
      file.string(),
      version.dump(),
      kDeepestJson
  );
}

class Importer {
 public:
  Importer(const fs::path& file, TraceScene& scene) : file_(file), scene_(scene) {
    check_gltf(file);
    model_ = importer_.ReadFile(
        file.string(),
        aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_GenSmoothNormals |
            aiProcess_JoinIdenticalVertices | aiProcess_SortByPType
    );
    GLINT_CHECK(
        model_ != nullptr,
        kBadReference,
        "{}: cannot be imported ({}); expected glTF 2.0",
        file.string(),
        importer_.GetErrorString()
    );
  }

  Furniture furniture() {
    Furniture result;
    for (unsigned i = 0; i < model_->mNumMeshes; ++i) {
      const aiMesh& mesh = *model_->mMeshes[i];
      if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
      result.push_back({triangle_mesh(mesh), material(mesh.mMaterialIndex)});
    }
    GLINT_CHECK(!result.empty(), kBadReference, "{}: has no triangles", file_.string());
    for (const FurniturePart& part : result)
      for (const Vec3f v : part.mesh.vertices)
        GLINT_CHECK(
            std::isfinite(v.x + v.y + v.z),
            kBadReference,
            "{}: a vertex is not finite; export it again",
            file_.string()
        );
    stand_against_wall(result);
    return result;
  }

 private:
  // glTF has y up and its front along +z; furniture.h has z up and its front along +y.
  static Vec3f turned(const aiVector3D& v) { return {-v.x, v.z, v.y}; }

  static TraceMesh triangle_mesh(const aiMesh& mesh) {
    TraceMesh result;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      result.vertices.push_back(turned(mesh.mVertices[i]));
      result.normals.push_back(turned(mesh.mNormals[i]));
      // assimp counts v upwards, as PNG rows do not: texture rows grow downwards.
      const bool textured = mesh.HasTextureCoords(0);
      result.uvs.push_back(
          textured ? Vec2f{mesh.mTextureCoords[0][i].x, 1 - mesh.mTextureCoords[0][i].y} : Vec2f{}
      );
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const unsigned* v = mesh.mFaces[i].mIndices;
      result.faces.push_back(
          {static_cast<int>(v[0]), static_cast<int>(v[1]), static_cast<int>(v[2])}
      );
    }
    return result;
  }

  int material(unsigned index) {
    const auto known = materials_.find(index);
    if (known != materials_.end()) return known->second;
    GLINT_CHECK(
        index < model_->mNumMaterials, kBadReference, "{}: no material {}", file_.string(), index
    );
    const aiMaterial& source = *model_->mMaterials[index];
    Material material{.name = file_.stem().string(), .albedo = {0.8f, 0.8f, 0.8f}};
    aiColor4D color;
    if (source.Get(AI_MATKEY_BASE_COLOR, color) == AI_SUCCESS)
      material.albedo = {
          std::clamp(color.r, 0.0f, 0.95f),
          std::clamp(color.g, 0.0f, 0.95f),
          std::clamp(color.b, 0.0f, 0.95f)};
    aiString texture;
    if (source.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) == AI_SUCCESS ||
        source.GetTexture(aiTextureType_DIFFUSE, 0, &texture) == AI_SUCCESS)
      material.texture = add_texture(scene_, read_texture(texture.C_Str()));
    return materials_[index] = add_material(scene_, std::move(material));
  }

  Image read_texture(const std::string& name) const {
    GLINT_CHECK(
        !name.empty() && name[0] != '*' && !name.starts_with("data:"),
        kBadReference,
        "{}: has an embedded texture; expected image files beside it",
        file_.string()
    );
    Image image = read_image(file_.parent_path() / name, 3);
    for (float& value : image.values()) value = std::min(srgb_decode(value), 0.95f);
    const int largest = std::max(image.width(), image.height());
    if (largest <= kMaxTexture) return image;
    return resize_image(
        image, {image.width() * kMaxTexture / largest, image.height() * kMaxTexture / largest}
    );
  }

  static void stand_against_wall(Furniture& furniture) {
    const Bounds bounds = bounds_of(furniture);
    const Vec3f size = bounds.size();
    const float scale = std::min(1.0f, kMaxSize / std::max({size.x, size.y, size.z}));
    const Vec3f origin{bounds.center().x, bounds.low.y, bounds.low.z};
    for (FurniturePart& part : furniture)
      for (Vec3f& vertex : part.mesh.vertices) vertex = scale * (vertex - origin);
  }

  fs::path file_;
  TraceScene& scene_;
  Assimp::Importer importer_;
  const aiScene* model_ = nullptr;
  std::map<unsigned, int> materials_;
};

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
      assets.push_back({entry.first, Importer(entry.second, scene).furniture()});
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
