// SPDX-License-Identifier: MIT
#include "datasets/glassroom/import_model.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/DefaultIOSystem.h>
#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr int kMaxTexture = 512;  // pixels; larger textures are area averaged

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

bool is_inside(const fs::path& file, const fs::path& folder) {
  const fs::path inside = fs::absolute(folder / "").lexically_normal();
  const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(inside);
  return !relative.empty() && *relative.begin() != "..";
}

void check_inside(const fs::path& file, const fs::path& folder) {
  GLINT_CHECK(
      is_inside(file, folder),
      kBadReference,
      "{}: lies outside of {}; move the model's files into its folder",
      file.string(),
      folder.string()
  );
}

// An open file that is on a list for as long as it lives.
class ListedFile : public Assimp::IOStream {
 public:
  ListedFile(std::unique_ptr<Assimp::IOStream> file, std::set<ListedFile*>& list)
      : file_(std::move(file)), list_(list) {
    list_.insert(this);
  }
  ~ListedFile() override { list_.erase(this); }
  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    return file_->Read(to, size, count);
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    return file_->Seek(offset, origin);
  }
  std::size_t Tell() const override { return file_->Tell(); }
  std::size_t FileSize() const override { return file_->FileSize(); }
  void Flush() override {}

 private:
  std::unique_ptr<Assimp::IOStream> file_;
  std::set<ListedFile*>& list_;
};

// A model opens files of its own folder, and no others. What assimp leaves open when it gives a
// file up is closed here.
class FolderFiles : public Assimp::DefaultIOSystem {
 public:
  explicit FolderFiles(fs::path folder) : folder_(std::move(folder)) {}
  ~FolderFiles() override {
    while (!open_.empty()) delete *open_.begin();
  }
  bool Exists(const char* file) const override {
    return is_inside(file, folder_) && DefaultIOSystem::Exists(file);
  }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (!is_inside(name, folder_) || !or_warn([&] { return is_file(name); })) return nullptr;
    std::unique_ptr<Assimp::IOStream> file(DefaultIOSystem::Open(name, mode));
    return file == nullptr ? nullptr : new ListedFile(std::move(file), open_);
  }

 private:
  fs::path folder_;
  std::set<ListedFile*> open_;
};

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
  Importer(const fs::path& file, TraceScene& scene, const fs::path& texture)
      : file_(file), scene_(scene), texture_(texture) {
    check_exists(file);
    if (lower_extension(file) != ".obj") check_gltf(file);
    importer_.SetIOHandler(new FolderFiles(file.parent_path()));  // which the importer owns
    model_ = importer_.ReadFile(
        file.string(),
        aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_GenSmoothNormals |
            aiProcess_JoinIdenticalVertices | aiProcess_SortByPType
    );
    GLINT_CHECK(
        model_ != nullptr,
        kBadReference,
        "{}: cannot be imported ({}); expected glTF 2.0 or OBJ",
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
        index < model_->mNumMaterials, kBadReference, "{}: no material {}", file_.string(), index
    );
    const aiMaterial& source = *model_->mMaterials[index];
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
  Assimp::Importer importer_;
  const aiScene* model_ = nullptr;
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
