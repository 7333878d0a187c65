// SPDX-License-Identifier: MIT
// nerfstudio's transforms.json (transforms_json.h) with its split lists and its point cloud.
#include <set>

#include "datasets/dataset.h"
#include "datasets/transforms_json.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

// The paths of a split list, normalised as view names are before shortening.
std::set<std::string> read_list(const Json& json, const char* key, const std::string& where) {
  std::set<std::string> paths;
  if (!json.contains(key)) return paths;
  GLINT_CHECK(json[key].is_array(), kBadReference, "{}: {}: expected a list", where, key);
  for (const Json& path : json[key]) {
    GLINT_CHECK(path.is_string(), kBadReference, "{}: {}: expected texts", where, key);
    paths.insert(fs::path(with_slashes(path.get<std::string>())).lexically_normal().string());
  }
  return paths;
}

// Names that no frame has stop the loading: a view of the list would silently be in another one.
void look_for_strangers(
    const std::set<std::string>& list, const char* key, const std::string& where, SceneIndex& index
) {
  std::set<std::string> strangers = list;
  for (const ViewSource& view : index.views) strangers.erase(view.name);
  if (!strangers.empty())
    index.problems.push_back(
        {"split-list",
         where,
         fmt::format(
             "{}: {} of {} names are no frame's file_path, such as '{}'",
             key,
             strangers.size(),
             list.size(),
             *strangers.begin()
         )}
    );
}

// Without lists every test_every-th view is a test view; without test_filenames, val_filenames
// serve. Returns the rule in words.
std::string split_views(
    const Json& json, const std::string& where, const LoadOptions& options, SceneIndex& index
) {
  const std::set<std::string> train = read_list(json, "train_filenames", where);
  std::set<std::string> test = read_list(json, "test_filenames", where);
  const char* key = test.empty() ? "val_filenames" : "test_filenames";
  if (test.empty()) test = read_list(json, key, where);
  if (train.empty() && test.empty()) return split_every(index.views, options.test_every);
  look_for_strangers(train, "train_filenames", where, index);
  look_for_strangers(test, key, where, index);
  for (ViewSource& view : index.views) {
    view.is_test = test.contains(view.name);
    view.is_train = train.empty() ? !view.is_test : train.contains(view.name);
  }
  return fmt::format("{} of transforms.json", test.empty() ? "train_filenames" : key);
}

LoaderMatch match(const fs::path& folder) {
  const fs::path file = folder / "transforms.json";
  if (!is_there(file)) return {};
  if (!file_contains(file, "\"frames\"")) return {Sureness::kName, "transforms.json"};
  return {Sureness::kContents, "transforms.json with frames"};
}

}  // namespace

SceneIndex index_nerfstudio(const fs::path& folder, const LoadOptions& options) {
  const fs::path file = folder / "transforms.json";
  const Json json = parse_transforms(file);
  SceneIndex index;
  index.name = folder_name(folder);
  index.dataset = "nerfstudio";
  read_frames(json, file, index);
  sort_naturally(index.views);
  index.split_rule = split_views(json, file.string(), options, index);
  shorten_names(index.views);
  if (const auto points = json.find("ply_file_path"); points != json.end()) {
    GLINT_CHECK(
        points->is_string(),
        kBadReference,
        "{}: ply_file_path is {}, expected a text",
        file.string(),
        points->dump()
    );
    index.points = folder / with_slashes(points->get<std::string>());
  }
  index.spec_hash = hash_of_files(json.dump(), index.views);
  return index;
}

GLINT_REGISTER(
    LoaderSpec, indexed_loader("nerfstudio", match, index_nerfstudio, "transforms.json with frames")
)

}  // namespace glint
