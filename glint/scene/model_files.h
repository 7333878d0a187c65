// SPDX-License-Identifier: MIT
// Models of others as assimp has them: OBJ, glTF 2.0 and STL. Library glint_models.
#pragma once

#include <memory>

#include "glint/core/files.h"

struct aiScene;
namespace Assimp {
class Importer;
}

namespace glint {

// What is read is the file's own: axes and units as stored (of glTF: y up, metres), places of
// nodes applied, faces as triangles.
class ModelFile {
 public:
  // `steps`: assimp's aiProcess_* beside triangulation and nodes' places. Errors (kBadReference):
  // no such file, none of these formats, files of the model outside of its folder.
  ModelFile(const fs::path& file, unsigned steps);
  ~ModelFile();

  const aiScene& scene() const { return *scene_; }

 private:
  std::unique_ptr<Assimp::Importer> importer_;
  const aiScene* scene_ = nullptr;
};

// Errors (kBadReference): the file lies outside of the folder.
void check_inside(const fs::path& file, const fs::path& folder);

}  // namespace glint
