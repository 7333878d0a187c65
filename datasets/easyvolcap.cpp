// SPDX-License-Identifier: MIT
// EasyVolcap's folder layout, as GLINT's official release and our GlassRoom generator write it:
//   images/<view>/000000.{png,jpg}   intri.yml   extri.yml   sparse/0/points3D.ply
//   diffrens/<prior>/<view>/000000.png
// and, of GlassRoom and of what `dataset export` writes:
//   gt/<truth>/<view>.exr (masks: .png)   scene.json
// Priors and truth are those of the table (glint/scene/maps.h).
#include <set>

#include "datasets/dataset.h"
#include "datasets/opencv_yaml.h"
#include "datasets/scene_index.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

LoaderMatch match(const fs::path& folder) {
  if (!is_there(folder / "intri.yml")) return {};
  const bool complete = is_there(folder / "extri.yml") && is_folder(folder / "images");
  if (!complete || !file_contains(folder / "intri.yml", "K_"))
    return {Sureness::kName, "intri.yml"};
  return {Sureness::kContents, "intri.yml with cameras, extri.yml and images"};
}

// The view's only frame; a name that does not exist when the folder has none.
fs::path first_frame(const fs::path& view_folder) {
  if (!is_folder(view_folder)) return view_folder / "000000.png";
  const std::vector<fs::path> files = list_files(view_folder, kPictureExtensions);
  return files.empty() ? view_folder / "000000.png" : files.front();
}

MapFiles find_priors(const fs::path& folder, const std::string& view) {
  MapFiles files;
  for (const MapRow& row : maps())
    if (!row.prior.empty() && is_folder(folder / row.prior))
      files[row] = first_frame(folder / row.prior / view);
  return files;
}

MapFiles find_truth(const fs::path& folder, const std::string& view) {
  MapFiles files;
  for (const MapRow& row : maps())
    if (!row.truth.empty() && is_folder(folder / row.truth))
      files[row] = folder / true_map_file(row, view);
  return files;
}

ViewSource make_view(const fs::path& folder, const OpencvCamera& camera) {
  ViewSource view;
  view.name = camera.name;
  view.where = fmt::format("{}: camera {}", (folder / "extri.yml").string(), camera.name);
  view.image = first_frame(folder / "images" / camera.name);
  view.camera = camera.camera;
  view.distortion = camera.distortion;
  view.priors = find_priors(folder / "diffrens", camera.name);
  view.truth = find_truth(folder / "gt", camera.name);
  return view;
}

// EasyVolcap is made for videos; a scene here stands still. Both remarks name the first folder.
void remark_passed_over(const fs::path& folder, SceneIndex& index) {
  std::set<std::string> cameras;
  for (const ViewSource& view : index.views) cameras.insert(view.name);
  std::vector<fs::path> videos, strangers;
  for (const fs::path& pictures : list_folders(folder / "images")) {
    const std::size_t frames = list_files(pictures, kPictureExtensions).size();
    if (!cameras.contains(pictures.filename().string())) {
      if (frames > 0) strangers.push_back(pictures);
    } else if (frames > 1) {
      videos.push_back(pictures);
    }
  }
  if (!videos.empty())
    index.remarks.push_back(
        {"extra-frames",
         videos.front().string(),
         fmt::format(
             "{} frames, of {} views several: each view's first is read, here {}",
             list_files(videos.front(), kPictureExtensions).size(),
             videos.size(),
             first_frame(videos.front()).filename().string()
         )}
    );
  if (!strangers.empty())
    index.remarks.push_back(
        {"picture-without-camera",
         strangers.front().string(),
         fmt::format(
             "no camera of this name in extri.yml, one of {} such folders; they are not read",
             strangers.size()
         )}
    );
}

SceneIndex index_folder(const fs::path& folder, const LoadOptions& options) {
  const fs::path intri = folder / "intri.yml", extri = folder / "extri.yml";
  SceneIndex index;
  index.name = folder_name(folder);
  index.dataset = "easyvolcap";
  for (const OpencvCamera& camera : read_opencv_cameras(intri, extri)) {
    index.views.push_back(make_view(folder, camera));
    for (const std::string& problem : camera.problems)
      index.problems.push_back({"camera-field", "camera " + camera.name, problem});
  }
  remark_passed_over(folder, index);
  sort_by_bytes(index.views);  // EasyVolcap splits in this order
  index.split_rule = split_every(index.views, options.test_every);
  sort_naturally(index.views);
  const fs::path points = folder / "sparse" / "0" / "points3D.ply";
  if (is_there(points)) index.points = points;
  index.spec_hash = hash_of_files(read_file(intri) + read_file(extri), index.views);
  return index;
}

}  // namespace

GLINT_REGISTER(
    LoaderSpec,
    indexed_loader("easyvolcap", match, index_folder, "intri.yml, extri.yml and images/<view>/")
)

}  // namespace glint
