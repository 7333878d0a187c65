// SPDX-License-Identifier: MIT
// A scene of ScanNet++ after its toolkit has undone the fisheye of the DSLR:
//   dslr/nerfstudio/transforms_undistorted.json   intrinsics, `frames`, `test_frames`; file_path is
//                                                 the picture's bare name
//   dslr/resized_undistorted_images/ (of the release) or dslr/undistorted_images/ (of the toolkit)
//   dslr/resized_undistorted_masks/ (of the release) or dslr/undistorted_anon_masks/ (of the
//                                                 toolkit): pixels that count (white); faces and
//                                                 the like are made unrecognisable
//   dslr/colmap/{images,points3D}.txt             poses and points in the frame of the laser scan
// The toolkit lists test frames among `frames`, too: what `test_frames` has is no training view.
// Poses of the JSON have other world axes than the points, so COLMAP's are taken where they are
// there; without them there are no points either.
#include <map>
#include <set>

#include "datasets/colmap_model.h"
#include "datasets/dataset.h"
#include "datasets/transforms_json.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

constexpr const char* kCameras = "dslr/nerfstudio/transforms_undistorted.json";
constexpr const char* kFisheye = "dslr/nerfstudio/transforms.json";
constexpr const char* kModel = "dslr/colmap";
constexpr const char* kNoMasks =
    "names masks (mask_path), but there is no folder of masks beside that of pictures: all pixels "
    "count";

LoaderMatch match(const fs::path& folder) {
  if (is_there(folder / kCameras) && file_contains(folder / kCameras, "\"frames\""))
    return {Sureness::kContents, kCameras};
  if (is_there(folder / kFisheye)) return {Sureness::kName, kFisheye};
  return {};
}

fs::path picture_folder(const fs::path& folder) {
  for (const char* name : {"dslr/resized_undistorted_images", "dslr/undistorted_images"})
    if (is_folder(folder / name)) return folder / name;
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: neither dslr/resized_undistorted_images nor dslr/undistorted_images; undistort with "
          "the toolkit of ScanNet++ (dslr.undistort)",
          folder.string()
      )
  );
}

std::string name_of(const Json& frame) {
  const Json name = frame.is_object() ? frame.value("file_path", Json()) : Json();
  return name.is_string() ? with_slashes(name.get<std::string>()) : std::string();
}

// Names of test frames; of what is no list, none.
std::set<std::string> test_names(const Json& json) {
  std::set<std::string> names;
  if (json.contains("test_frames") && json["test_frames"].is_array())
    for (const Json& frame : json["test_frames"]) names.insert(name_of(frame));
  return names;
}

// Beside the pictures, "../NAME/"; empty: there is none.
std::string mask_folder(const fs::path& pictures) {
  for (const char* masks : {"masks", "anon_masks"}) {
    std::string name = pictures.filename().string();
    name.replace(name.find("images"), 6, masks);
    if (is_folder(pictures.parent_path() / name)) return "../" + name + "/";
  }
  return {};
}

// mask_path, a bare name, from the file's folder on; without masks there is none.
void place_mask(const std::string& masks, Json& frame) {
  if (!frame.is_object() || !frame.contains("mask_path")) return;
  if (masks.empty())
    frame.erase("mask_path");
  else if (frame["mask_path"].is_string())
    frame["mask_path"] = masks + frame["mask_path"].get<std::string>();
}

// `frames` of all views, once each, with paths from the file's folder on.
Json all_frames(const Json& json, const fs::path& pictures) {
  Json all = json;
  all["frames"] = Json::array();
  const std::set<std::string> test = test_names(json);
  const std::string prefix = "../" + pictures.filename().string() + "/";
  const std::string masks = mask_folder(pictures);
  const auto add = [&](Json frame) {
    if (const std::string name = name_of(frame); !name.empty()) frame["file_path"] = prefix + name;
    place_mask(masks, frame);
    all["frames"].push_back(std::move(frame));
  };
  for (const Json& frame : json["frames"])
    if (!test.contains(name_of(frame))) add(frame);
  if (!test.empty())
    for (const Json& frame : json["test_frames"]) add(frame);
  return all;
}

// Test pictures of the benchmark's hidden scenes are not given out.
void drop_hidden(const std::set<std::string>& test, SceneIndex& index) {
  const auto is_hidden = [&](const ViewSource& view) {
    return test.contains(view.image.filename().string()) && !is_there(view.image);
  };
  const std::size_t hidden = std::erase_if(index.views, is_hidden);
  if (hidden > 0)
    index.remarks.push_back(
        {"hidden-test-views",
         kCameras,
         fmt::format("{} test views have no picture and are left out", hidden)}
    );
}

// Poses by the pictures' names. Returns whether all were there.
bool take_colmap_poses(const fs::path& folder, SceneIndex& index) {
  const fs::path files = folder / kModel;
  if (!is_there(files / "images.txt") && !is_there(files / "images.bin")) return false;
  std::map<std::string, ColmapImage> images;
  for (ColmapImage& image : read_colmap_model(files).images)
    images.emplace(fs::path(with_slashes(image.name)).filename().string(), std::move(image));
  for (ViewSource& view : index.views) {
    const auto image = images.find(view.image.filename().string());
    if (image == images.end()) {
      index.problems.push_back(
          {"pose",
           view.where,
           fmt::format("{} has no pose of it; all views or none have to be in it", files.string())}
      );
      return false;
    }
    view.camera.rotation_cam_from_world = rotation_of(image->second);
    view.camera.translation_cam_from_world = image->second.translation_cam_from_world;
  }
  return true;
}

std::string split_views(
    const std::set<std::string>& test, const LoadOptions& options, std::vector<ViewSource>& views
) {
  bool any = false;
  for (ViewSource& view : views) {
    view.is_test = test.contains(view.image.filename().string());
    view.is_train = !view.is_test;
    any = any || view.is_test;
  }
  if (any) return "test_frames of transforms_undistorted.json";
  return split_every(views, options.test_every);
}

SceneIndex index_folder(const fs::path& folder, const LoadOptions& options) {
  const fs::path file = folder / kCameras, pictures = picture_folder(folder);
  const Json json = parse_transforms(file);
  const std::set<std::string> test = test_names(json);
  SceneIndex index;
  index.name = folder_name(folder);
  index.dataset = "scannetpp";
  read_frames(all_frames(json, pictures), file, index);
  if (mask_folder(pictures).empty() && file_contains(file, "\"mask_path\""))
    index.remarks.push_back({"mask-path", kCameras, kNoMasks});
  drop_hidden(test, index);
  sort_naturally(index.views);
  if (take_colmap_poses(folder, index)) index.points = find_colmap_points(folder / kModel);
  index.split_rule = split_views(test, options, index.views);
  shorten_names(index.views);
  index.spec_hash = hash_of_files(json.dump(), index.views);
  return index;
}

}  // namespace

GLINT_REGISTER(LoaderSpec, indexed_loader("scannetpp", match, index_folder, kCameras))

}  // namespace glint
