// SPDX-License-Identifier: MIT
// What a folder says about a scene before any image is read: one ViewSource per view. Loaders make
// it, load_indexed() reads what it lists, check_indexed() looks for everything wrong with it.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/dataset.h"
#include "datasets/findings.h"
#include "glint/core/presence.h"
#include "glint/scene/camera.h"

namespace glint {

// Where the maps of a view lie; empty where the dataset has none of the kind.
using MapFiles = BasicMapSet<fs::path>;

// What is made of a picture's alpha channel: what lies on black or on white, a mask of the pixels
// that count, or nothing: colours as the file has them.
enum class AlphaUse { kBlack, kWhite, kMask, kStored };

struct ViewSource {
  std::string name;
  std::string where;  // the camera's place in its file, for messages
  fs::path image;
  fs::path counted;  // mask of the pixels that count (white); empty: all do
  Camera camera;     // as stated; width and height 0 where not stated
  bool scales_with_image =
      false;  // intrinsics follow the image when its size is not the stated one
  std::vector<double> distortion;  // OpenCV's order k1 k2 p1 p2 k3; empty: none
  bool is_train = false, is_test = false;
  AlphaUse alpha = AlphaUse::kBlack;
  MapFiles priors, truth;
  double depth_scale = 1e-3;  // metres of a step of true depth as 16-bit PNG
  // The program whose file a prior is, in words (prior_files.h): it is resized to the image and
  // decoded as that program stores it. Empty: a file of the folder's own format.
  BasicMapSet<std::string> prior_programs;
  PriorReading prior_reading;
  fs::path metallic;  // for an albedo from the base colour; empty: none
};

struct SceneIndex {
  std::string name, dataset, spec_hash;
  fs::path folder;  // for messages
  bool simulated_priors = false;
  fs::path points;                // empty: none
  std::vector<ViewSource> views;  // natural order of names
  std::string split_rule;         // how test views were chosen, for people
  std::vector<Finding> problems;  // found while reading the camera files; the first stops load()
  std::vector<Finding> remarks;   // files passed over: check() names them, load() notes them
  PriorOptions stated_priors;     // by scene.json
  // What the format says of its priors, before options and evidence.
  PriorReading documented_priors;
  std::vector<std::string> prior_notes;  // for people
};

// Fewer are no start for surfels, whose sizes come from three neighbours (neighbor_distances).
inline constexpr std::size_t kFewestPoints = 4;

// Does the file's text hold `part`? False when it cannot be read: a loader that matches a folder
// leaves the message to load().
bool file_contains(const fs::path& file, std::string_view part);

// A path as a file names it, by which folders and files are looked for: backslashes, which programs
// on Windows write, count as slashes.
std::string with_slashes(std::string path);

// A picture, or its smaller copy where captures ship those alone, or beside it: of DIR_2/, DIR_4/
// and DIR_8/ the largest that has it. `path` itself where none has.
fs::path picture_or_copy(const fs::path& path);
// A picture, or the only file of its folder that is called alike (similar_names.h); `path` itself
// where there is none, or several.
fs::path picture_called_alike(const fs::path& path);

// The folder's own name, also for "." and names that end in a slash.
std::string folder_name(const fs::path& folder);

// View i of the given order is a test view when i % test_every == 0; 0: all train. Returns the rule
// in words.
std::string split_every(std::vector<ViewSource>& views, int test_every);

// Views with these names are test views, all others train. Returns a name that no view has; empty:
// there is none.
std::string hold_out(std::set<std::string> names, std::vector<ViewSource>& views);

void sort_naturally(std::vector<ViewSource>& views);
void sort_by_bytes(std::vector<ViewSource>& views);  // of the names: 10 before 2
// Names that are paths of pictures become the stem, or the whole path with '_' where stems repeat.
void shorten_names(std::vector<ViewSource>& views);

// Hexadecimal hash of the camera files' text and of the names and sizes of the images.
std::string hash_of_files(const std::string& camera_text, const std::vector<ViewSource>& views);

// The view's camera at the size of its stored image. Errors (kBadReference): camera_problem(),
// stated size and image size do not go together.
Camera camera_at(const ViewSource& source, ImageSize image);

// One view as stored: neither undistorted nor resized. Errors (kBadReference): missing or
// unreadable files, maps of another size than the image, values that are not finite.
View read_view(const ViewSource& source, const LoadOptions& options);

// Why its folder cannot stand in records; empty: it can.
std::string scene_name_problem(const SceneIndex& index);

// Why a scene cannot be trained on: there is no view, or the split makes all of them test views.
std::string no_train_views(const SceneIndex& index);

// The scene: reads, undistorts and resizes all views and the points. Errors (kBadReference): the
// first of `problems`, no train views, and read_view()'s.
Scene load_indexed(const SceneIndex& index, const LoadOptions& options);

// The same without pictures and maps (LoaderSpec::outline). Errors (kBadReference): the first of
// `problems`, no train views, points that cannot be read.
Scene outline_indexed(const SceneIndex& index);

// Everything wrong with the files, the split, the points, and maps against cameras.
std::vector<Finding> check_indexed(const SceneIndex& index);

// A loader whose folders `index` lists: it loads, checks and tells the split by the above, and by
// what the folder says of itself (scene_json.h).
using FolderIndexer = std::function<SceneIndex(const fs::path&, const LoadOptions&)>;
LoaderSpec indexed_loader(
    const std::string& name,
    std::function<LoaderMatch(const fs::path&)> match,
    FolderIndexer index,
    const std::string& looks_for
);

// PLY, or COLMAP's points3D.bin or .txt.
PointCloud read_points(const fs::path& path);

// Readers of single maps, values checked to be finite. True depth as PNG is in steps of
// `depth_scale` metres, in any other file in metres.
Image read_true_map(const fs::path& path, MapKind kind, double depth_scale = 1e-3);
// The same without a look at the values; masks in [0, 1].
Image read_true_values(const fs::path& path, MapKind kind, double depth_scale = 1e-3);

}  // namespace glint
