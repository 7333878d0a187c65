// SPDX-License-Identifier: MIT
#include "reports/run/import/prediction_files.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files_stored.h"
#include "glint/scene/mesh_files.h"
#include "reports/run/records/run_folder.h"

namespace glint {
namespace {

// Where other programs put their maps.
const std::vector<MapPlaces> kOtherPrograms = {
    {"rgb",
     {"renders/val_[0-9][0-9][0-9][0-9].png",
      "renders/val_step*_[0-9][0-9][0-9][0-9].png",
      "renders/*.exr",
      "renders/*.png",
      "renders/*.jpg",
      "test/ours_*/renders/*.png",
      "ours_*/renders/*.png",
      "test/rgb/*.png",
      "test/rgb/*.jpg",
      "renders/test/rgb/*.png",
      "renders/test/rgb/*.jpg",
      "RENDER/*_camera[0-9][0-9][0-9][0-9].png",  // not their _gt and _error beside them
      "RENDER/*_camera[0-9][0-9][0-9][0-9].jpg",
      "RENDER/*_camera[0-9][0-9][0-9][0-9].exr",
      "RENDER/*.png",
      "RENDER/*.jpg",
      "RENDER/*.exr",
      "pred/*.png",
      "color/*.png",
      "color/*.jpg",
      "rgb/*.exr",
      "rgb/*.png",
      "rgb/*.jpg",
      "rgb/*.npy",
      "images/*.png",
      "*.png",
      "*.jpg"}},
    {"depth",
     {"depth/*.exr",
      "depth/*.npy",
      "depth/*.tiff",
      "depths/*.exr",
      "depths/*.npy",
      "depths/*.tiff",
      "geo_metric/depths_pred/*.npy",
      "geometry/depths_pred/*.npy",
      "depths_pred/*.npy",
      "test/ours_*/depth/*.npy",
      "test/ours_*/vis/depth_*.exr",
      "test/ours_*/vis/depth_*.npy",
      "test/ours_*/vis/depth_*.tiff",
      "vis/depth_*.tiff",
      "*_depth.exr",
      "*_depth.npy",
      "depth/*.png",  // of 16 bits, see are_steps()
      "depths/*.png",
      "*_depth.png"}},
    {"normal",
     {"normal/*.exr",
      "normal/*.npy",
      "normals/*.exr",
      "normals/*.npy",
      "geo_metric/normals_pred/*.npy",
      "geometry/normals_pred/*.npy",
      "normals_pred/*.npy",
      "test/ours_*/normal/*.npy",
      "*_normal.exr",
      "*_normal.npy"}},
    {"transparency", {"transparency/*.png"}}};

// Those of a run folder of ours, those of other programs, and a folder of the map's own name.
MapPlaces places_of(const MapRow& row) {
  MapPlaces found{std::string(row.id), {}};
  const auto add = [&](std::string place) {
    if (std::find(found.places.begin(), found.places.end(), place) == found.places.end())
      found.places.push_back(std::move(place));
  };
  for (const std::string_view file : {row.file, row.picture})
    if (!file.empty()) add(fmt::format("renders/{}", file));
  if (!row.file.empty()) add(fmt::format("renders/{}.npy", row.id));
  for (const MapPlaces& other : kOtherPrograms)
    if (other.map == row.id)
      for (const std::string& place : other.places) {
        add(place);
        if (!place.ends_with(".jpg")) continue;
        for (const char* ending : {".jpeg", ".webp", ".bmp"})
          add(fs::path(place).replace_extension(ending).string());
      }
  if (!row.file.empty())
    for (const char* extension : {"exr", "npy"}) add(fmt::format("{}/*.{}", row.id, extension));
  return found;
}

struct FoundFile {
  std::string name;  // of the file without extension, or of its view's folder
  fs::path path;
};

// What is in it where it is a folder.
std::vector<fs::path> list_if_folder(const fs::path& path) {
  return is_folder(path) ? list_entries(path) : std::vector<fs::path>();
}

// Folders that `pattern` means below `root`; a part with '*' means its last match.
fs::path resolve(const fs::path& root, const std::string& pattern) {
  fs::path folder = root;
  for (const fs::path& part : fs::path(pattern)) {
    std::string best;
    for (const fs::path& entry : list_if_folder(folder)) {
      const std::string name = entry.filename().string();
      if (glob_match(part.string(), name) && is_folder(entry) &&
          (best.empty() || natural_less(best, name)))
        best = name;
    }
    if (best.empty()) return {};
    folder /= best;
  }
  return folder;
}

bool by_name(const FoundFile& a, const FoundFile& b) { return natural_less(a.name, b.name); }

// Files of the pattern side by side, or one in a folder per view.
std::vector<FoundFile> files_in(const fs::path& folder, const std::string& pattern) {
  std::vector<FoundFile> files;
  for (const fs::path& path : list_if_folder(folder)) {
    if (glob_match(pattern, path.filename().string()) && is_file(path))
      files.push_back({path.stem().string(), path});
    if (!is_folder(path)) continue;
    for (const fs::path& inside : list_files(path))
      if (glob_match(pattern, inside.filename().string())) {
        files.push_back({path.filename().string(), inside});
        break;
      }
  }
  std::sort(files.begin(), files.end(), by_name);
  return files;
}

// Depth as PNG is mostly a picture for people: of 16 bits it counts steps.
bool are_steps(const std::vector<FoundFile>& files) {
  return integer_range(files.front().path) == 65535 && !is_colored_png(files.front().path);
}

std::vector<FoundFile> find_map(const fs::path& root, const MapPlaces& map) {
  for (const fs::path place : map.places) {
    const fs::path folder = resolve(root, place.parent_path().string());
    if (folder.empty()) continue;
    auto files = files_in(folder, place.filename().string());
    const bool is_picture = map.map == "depth" && place.extension() == ".png";
    if (!files.empty() && (!is_picture || are_steps(files))) return files;
  }
  return {};
}

const FoundFile* find_name(const std::vector<FoundFile>& files, const std::string& view) {
  const std::string flat = flat_view_name(view);
  for (const FoundFile& file : files)
    if (file.name == view || file.name == flat || file.name == fs::path(view).stem().string())
      return &file;
  return nullptr;
}

bool all_named(const std::vector<FoundFile>& files, const std::vector<std::string>& views) {
  return std::all_of(views.begin(), views.end(), [&](const std::string& view) {
    return find_name(files, view) != nullptr;
  });
}

void add_map(
    const std::string& map,
    const std::vector<FoundFile>& files,
    const std::vector<std::string>& views,
    PredictionFiles& found
) {
  const bool named = all_named(files, views);
  GLINT_CHECK(
      named || files.size() == views.size(),
      kBadPrediction,
      "{}: {} files for {} ({}, ...), but {} test views ({}, ...); name the files as the views or "
      "give one for each",
      files.front().path.parent_path().string(),
      files.size(),
      map,
      files.front().name,
      views.size(),
      views.front()
  );
  found.matching[map] = named ? Matching::kName : Matching::kOrder;
  for (std::size_t i = 0; i < views.size(); ++i)
    found.views[i][map] = named ? find_name(files, views[i])->path : files[i].path;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

fs::path find_mesh(const fs::path& root) {
  for (const char* candidate :
       {"mesh.ply",
        "mesh/tsdf_fusion_interface_post.ply",
        "mesh/tsdf_fusion_post.ply",
        "mesh/tsdf_fusion.ply"})
    if (const fs::path mesh = mesh_or_model(root / candidate); is_file(mesh)) return mesh;
  const fs::path train = resolve(root, "train/ours_*");
  for (const char* candidate : {"fuse_post.ply", "fuse_unbounded_post.ply", "fuse.ply"})
    if (!train.empty() && is_file(train / candidate)) return train / candidate;
  return {};
}

}  // namespace

std::vector<fs::path> unread_files(
    const fs::path& folder, const std::string& map, const PredictionFiles& found
) {
  constexpr int kDeepest = 4;  // of the layouts above
  std::set<fs::path> read;
  for (const auto& view : found.views)
    for (const auto& [id, path] : view) read.insert(path);
  std::vector<fs::path> unread;
  const auto is_deep = [&](const fs::path& path) {
    const fs::path below = path.lexically_relative(folder);
    return std::distance(below.begin(), below.end()) > kDeepest + 1;
  };
  for (const fs::path& path : or_warn([&] { return list_files_below(folder, is_deep); })) {
    const std::string name =
        lower(path.parent_path().filename().string() + "/" + path.filename().string());
    if (name.find(map) != std::string::npos && !read.contains(path)) unread.push_back(path);
  }
  return unread;
}

std::vector<MapPlaces> map_places() {
  std::vector<MapPlaces> places;
  for (const MapRow& row : maps())
    if (!row.stored_file().empty()) places.push_back(places_of(row));
  return places;
}

PredictionFiles find_predictions(
    const fs::path& folder, const std::vector<std::string>& view_names
) {
  GLINT_CHECK(is_folder(folder), kBadPrediction, "{}: no such folder", folder.string());
  PredictionFiles found;
  found.views.resize(view_names.size());
  for (const MapPlaces& places : map_places())
    if (const auto files = find_map(folder, places); !files.empty())
      add_map(places.map, files, view_names, found);
  GLINT_CHECK(
      found.matching.contains("rgb"),
      kBadPrediction,
      "{}: no renders; looked for {}",
      folder.string(),
      fmt::join(map_places().front().places, ", ")
  );
  found.mesh = find_mesh(folder);
  return found;
}

}  // namespace glint
