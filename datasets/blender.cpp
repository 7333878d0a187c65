// SPDX-License-Identifier: MIT
// Folders as Blender's NeRF exports are: transforms_train.json and transforms_test.json
// (transforms_json.h), mostly with camera_angle_x alone; transforms_val.json is not read.
// points3d.ply is read where 3DGS keeps it. Transparent pictures lie on white, as by custom.
#include "datasets/dataset.h"
#include "datasets/transforms_json.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

LoaderMatch match(const fs::path& folder) {
  const fs::path file = folder / "transforms_train.json";
  if (!is_there(file)) return {};
  if (is_there(folder / "transforms.json"))
    return {Sureness::kName, "transforms_train.json beside transforms.json"};
  if (!file_contains(file, "\"frames\"")) return {Sureness::kName, "transforms_train.json"};
  return {Sureness::kContents, "transforms_train.json with frames"};
}

// Adds the views of one file; nothing where it is missing.
std::string add_views(const fs::path& file, bool is_test, SceneIndex& index) {
  if (is_test && !is_there(file)) return {};
  const std::size_t first = index.views.size();
  const Json json = parse_transforms(file);
  read_frames(json, file, index);
  for (std::size_t i = first; i < index.views.size(); ++i) {
    index.views[i].is_test = is_test;
    index.views[i].is_train = !is_test;
    index.views[i].alpha = AlphaUse::kWhite;  // as NeRF and its successors have it
  }
  return json.dump();
}

SceneIndex index_folder(const fs::path& folder, const LoadOptions& options) {
  SceneIndex index;
  index.name = folder_name(folder);
  index.dataset = "blender";
  const std::string train = add_views(folder / "transforms_train.json", false, index);
  const std::string test = add_views(folder / "transforms_test.json", true, index);
  sort_naturally(index.views);
  index.split_rule = "transforms_test.json";
  if (test.empty()) index.split_rule = split_every(index.views, options.test_every);
  shorten_names(index.views);
  sort_naturally(index.views);
  if (const fs::path points = folder / "points3d.ply"; is_there(points)) index.points = points;
  index.spec_hash = hash_of_files(train + test, index.views);
  return index;
}

}  // namespace

GLINT_REGISTER(
    LoaderSpec,
    indexed_loader("blender", match, index_folder, "transforms_train.json and transforms_test.json")
)

}  // namespace glint
