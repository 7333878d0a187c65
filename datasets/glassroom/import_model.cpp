// SPDX-License-Identifier: MIT
#include "datasets/glassroom/import_model.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "glint/scene/model_files.h"

namespace glint {

namespace {

constexpr int kMaxTexture = 512;  // pixels; larger textures are area averaged

class Importer {
 public:
  Importer(const fs::path& file, TraceScene& scene, const fs::path& texture)
      : file_(file),
        scene_(scene),
        texture_(texture),
        model_(file, aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices) {}

  Furniture furniture() {
    Furniture result;
    for (unsigned i = 0; i < model_.scene().mNumMeshes; ++i) {
      const aiMesh& mesh = *model_.scene().mMeshes[i];
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
    return result;
  }

 private:
  static Vec3f vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }
  static bool is_finite(const aiVector3D& v) { return std::isfinite(v.x + v.y + v.z); }

  static TraceMesh triangle_mesh(const aiMesh& mesh) {
    TraceMesh result;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      result.vertices.push_back(vector_of(mesh.mVertices[i]));
      // Triangles without an area have no normal.
      const bool has_normal = is_finite(mesh.mNormals[i]) && mesh.mNormals[i].SquareLength() > 0;
      result.normals.push_back(has_normal ? vector_of(mesh.mNormals[i]) : Vec3f{0, 0, 1});
      // assimp counts v upwards, as PNG rows do not: texture rows grow downwards.
      const bool textured = mesh.HasTextureCoords(0) && is_finite(mesh.mTextureCoords[0][i]);
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
        index < model_.scene().mNumMaterials,
        kBadReference,
        "{}: no material {}",
        file_.string(),
        index
    );
    const aiMaterial& source = *model_.scene().mMaterials[index];
    Material material{.name = file_.stem().string(), .albedo = {0.8f, 0.8f, 0.8f}};
    aiColor4D color;
    if (source.Get(AI_MATKEY_BASE_COLOR, color) == AI_SUCCESS ||
        source.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS)
      material.albedo = {
          std::clamp(color.r, 0.0f, 0.95f),
          std::clamp(color.g, 0.0f, 0.95f),
          std::clamp(color.b, 0.0f, 0.95f)};
    aiString texture;
    if (!texture_.empty()) {
      material.albedo = {1, 1, 1};
      if (texture_index_ < 0) texture_index_ = add_texture(scene_, read_reflectance(texture_));
      material.texture = texture_index_;
    } else if (source.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) == AI_SUCCESS || source.GetTexture(aiTextureType_DIFFUSE, 0, &texture) == AI_SUCCESS)
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
    check_inside(file_.parent_path() / name, file_.parent_path());
    return read_reflectance(file_.parent_path() / name);
  }

  fs::path file_;
  TraceScene& scene_;
  fs::path texture_;  // of all materials; empty: their own
  int texture_index_ = -1;
  ModelFile model_;
  std::map<unsigned, int> materials_;
};

}  // namespace

Furniture import_model(const fs::path& file, TraceScene& scene, const fs::path& texture) {
  return Importer(file, scene, texture).furniture();
}

Image read_reflectance(const fs::path& picture) {
  Image image = read_image(picture, 3);
  for (float& value : image.values()) value = std::min(srgb_decode(value), 0.95f);
  const int largest = std::max(image.width(), image.height());
  if (largest <= kMaxTexture) return image;
  return resize_image(
      image,
      {std::max(1, image.width() * kMaxTexture / largest),
       std::max(1, image.height() * kMaxTexture / largest)}
  );
}

}  // namespace glint
