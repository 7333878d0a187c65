// SPDX-License-Identifier: MIT
#include "glint/scene/model_files.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/DefaultIOSystem.h>
#include <assimp/IOStream.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstring>
#include <set>
#include <utility>

#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/printable.h"
#include "glint/scene/mesh_files.h"

namespace glint {
namespace {

bool is_inside(const fs::path& file, const fs::path& folder) {
  const fs::path inside = fs::absolute(folder / "").lexically_normal();
  const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(inside);
  return !relative.empty() && *relative.begin() != "..";
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

// Vertices of all parts, one after the other; without faces of points and lines.
TriangleMesh triangles_of(const aiScene& scene) {
  TriangleMesh mesh;
  bool colored = scene.mNumMeshes > 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[m];
    if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    colored = colored && part.HasVertexColors(0);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D& v = part.mVertices[i];
      mesh.vertices.push_back({v.x, v.y, v.z});
      if (!colored) continue;
      const aiColor4D& color = part.mColors[0][i];
      mesh.colors.push_back({color.r, color.g, color.b});
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const unsigned* v = part.mFaces[i].mIndices;
      mesh.faces.push_back(
          {first + static_cast<int>(v[0]),
           first + static_cast<int>(v[1]),
           first + static_cast<int>(v[2])}
      );
    }
  }
  if (!colored) mesh.colors.clear();
  return mesh;
}

TriangleMesh read_by_assimp(const fs::path& path) {
  const ModelFile model(path, aiProcess_JoinIdenticalVertices | aiProcess_RemoveComponent);
  TriangleMesh mesh = triangles_of(model.scene());
  GLINT_CHECK(!mesh.faces.empty(), kBadReference, "{}: has no triangles", path.string());
  return mesh;
}

}  // namespace

void check_inside(const fs::path& file, const fs::path& folder) {
  GLINT_CHECK(
      is_inside(file, folder),
      kBadReference,
      "{}: lies outside of {}; move the model's files into its folder",
      file.string(),
      folder.string()
  );
}

ModelFile::ModelFile(const fs::path& file, unsigned steps)
    : importer_(std::make_unique<Assimp::Importer>()) {
  check_exists(file);
  const std::string kind = mesh_extension(file);
  if (kind == ".gltf" || kind == ".glb") check_gltf(file);
  const fs::path folder = fs::absolute(file).parent_path();
  importer_->SetIOHandler(new FolderFiles(folder));  // which the importer owns
  importer_->SetPropertyInteger(
      AI_CONFIG_PP_RVC_FLAGS,
      aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_TEXCOORDS |
          aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS | aiComponent_TEXTURES |
          aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS
  );
  scene_ = importer_->ReadFile(
      file.string(),
      steps | aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType
  );
  GLINT_CHECK(
      scene_ != nullptr,
      kBadReference,
      "{}: cannot be imported ({}); expected glTF 2.0, OBJ or STL",
      file.string(),
      printable(importer_->GetErrorString())
  );
}

ModelFile::~ModelFile() = default;

GLINT_PROVIDE(read_model, read_by_assimp)

}  // namespace glint
