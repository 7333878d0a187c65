// SPDX-License-Identifier: MIT
// A scene of DL3DV-10K as its benchmark ships it: HASH/nerfstudio/ with transforms.json (whole
// intrinsics, lens distortion) and images_2, images_4 or images_8, whose largest counts. Beside it
// HASH/gaussian_splat/ is another reconstruction, in another frame; to read that, name the folder
// itself (it is a COLMAP model with images_4). HASH.zip of the main set holds transforms.json and
// pictures directly: nerfstudio's loader reads it. A pickle in .cache is never opened.
#include "datasets/dataset.h"
#include "datasets/scene_index.h"
#include "datasets/transforms_json.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

LoaderMatch match(const fs::path& folder) {
  if (!is_there(folder / "nerfstudio/transforms.json")) return {};
  if (is_there(folder / "transforms.json"))
    return {Sureness::kName, "nerfstudio/transforms.json beside transforms.json"};
  if (!file_contains(folder / "nerfstudio/transforms.json", "\"frames\""))
    return {Sureness::kName, "nerfstudio/transforms.json"};
  return {Sureness::kContents, "nerfstudio/transforms.json with frames"};
}

SceneIndex index_folder(const fs::path& folder, const LoadOptions& options) {
  SceneIndex index = index_nerfstudio(folder / "nerfstudio", options);
  index.name = folder_name(folder);
  index.dataset = "dl3dv";
  return index;
}

}  // namespace

GLINT_REGISTER(
    LoaderSpec, indexed_loader("dl3dv", match, index_folder, "nerfstudio/transforms.json")
)

}  // namespace glint
