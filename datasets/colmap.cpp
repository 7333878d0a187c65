// SPDX-License-Identifier: MIT
// COLMAP folders as 3DGS, 2DGS and gsplat read them: images/ and sparse/0/ (or sparse/) with
// cameras, images and points3D as .bin or .txt. Test views are those that sparse/0/test.txt lists;
// without it every 8th in the order of names, byte by byte, as these programs have it.
#include <algorithm>
#include <set>
#include <sstream>

#include "datasets/colmap_model.h"
#include "datasets/dataset.h"
#include "datasets/scene_index.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

LoaderMatch match(const fs::path& folder) {
  const fs::path model = find_colmap_model(folder);
  if (model.empty()) return {};
  const char* const pictures[] = {"images", "images_2", "images_4", "images_8"};
  if (std::none_of(std::begin(pictures), std::end(pictures), [&](const char* name) {
        return is_folder(folder / name);
      }))
    return {Sureness::kName, "a COLMAP model"};
  // Folders of other formats often keep the model that they were made from.
  for (const char* other : {"transforms.json", "transforms_train.json", "intri.yml"})
    if (is_there(folder / other))
      return {Sureness::kName, fmt::format("a COLMAP model beside {}", other)};
  return {Sureness::kContents, "a COLMAP model and images"};
}

// Size, intrinsics and distortion (k1 k2 p1 p2 k3). Errors (kBadReference): a lens that is not
// undone here.
void read_lens(const ColmapCamera& from, const std::string& where, ViewSource& view) {
  const std::vector<double>& p = from.params;
  const std::string_view lens = kColmapLenses[from.lens].name;
  Camera& to = view.camera;
  const bool has_one_focal =
      lens == "SIMPLE_PINHOLE" || lens == "SIMPLE_RADIAL" || lens == "RADIAL";
  const bool has_two = lens == "PINHOLE" || lens == "OPENCV" || lens == "FULL_OPENCV";
  const bool is_rational =
      lens == "FULL_OPENCV" &&
      std::any_of(p.begin() + 9, p.end(), [](double value) { return value != 0; });
  GLINT_CHECK(
      (has_one_focal || has_two) && !is_rational,
      kBadReference,
      "{}: camera model {}; undistort the images first (colmap image_undistorter)",
      where,
      lens
  );
  constexpr std::uint64_t kMaxSide = 1 << 20;
  GLINT_CHECK(
      from.width >= 1 && from.height >= 1 && from.width <= kMaxSide && from.height <= kMaxSide,
      kBadReference,
      "{}: {} x {} is no size of a picture",
      where,
      from.width,
      from.height
  );
  to.width = static_cast<int>(from.width);
  to.height = static_cast<int>(from.height);
  const std::size_t center = has_one_focal ? 1 : 2;
  to.fx = p[0];
  to.fy = p[center - 1];
  to.cx = p[center];
  to.cy = p[center + 1];
  std::vector<double> distortion(p.begin() + static_cast<std::ptrdiff_t>(center) + 2, p.end());
  distortion.resize(5);
  if (std::any_of(distortion.begin(), distortion.end(), [](double d) { return d != 0; }))
    view.distortion = distortion;
}

ViewSource make_view(
    const ColmapModel& model, const ColmapImage& image, const fs::path& folder, std::string where
) {
  ViewSource view;
  view.name = fs::path(with_slashes(image.name)).lexically_normal().string();
  view.where = std::move(where);
  view.image = picture_called_alike(picture_or_copy(folder / "images" / view.name));
  view.scales_with_image = true;
  const auto camera = model.cameras.find(image.camera_id);
  GLINT_CHECK(
      camera != model.cameras.end(),
      kBadReference,
      "{}: camera {} is not in the file of cameras",
      view.where,
      image.camera_id
  );
  read_lens(camera->second, fmt::format("{}: camera {}", view.where, image.camera_id), view);
  view.camera.rotation_cam_from_world = rotation_of(image);
  view.camera.translation_cam_from_world = image.translation_cam_from_world;
  return view;
}

// Names of pictures, one a line.
std::set<std::string> read_names(const fs::path& path) {
  std::set<std::string> names;
  std::istringstream file(read_text(path));
  for (std::string line; std::getline(file, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (!line.empty()) names.insert(fs::path(with_slashes(line)).lexically_normal().string());
  }
  return names;
}

// Returns the rule in words.
std::string split_views(const fs::path& list, int test_every, std::vector<ViewSource>& views) {
  if (!is_there(list)) {
    sort_by_bytes(views);
    return split_every(views, test_every);
  }
  const std::string unknown = hold_out(read_names(list), views);
  GLINT_CHECK(
      unknown.empty(),
      kBadReference,
      "{}: no image is called {}; give the names of images.bin, with their extension",
      list.string(),
      unknown
  );
  return "sparse/0/test.txt";
}

std::string model_text(const ColmapModel& model) {
  std::string text;
  for (const auto& [id, camera] : model.cameras) {
    text += fmt::format("{} {} {} {}", id, camera.lens, camera.width, camera.height);
    for (const double value : camera.params) text += fmt::format(" {:.17g}", value);
  }
  for (const ColmapImage& image : model.images) {
    const Vec4<double>& q = image.rotation_cam_from_world;
    const Vec3d& t = image.translation_cam_from_world;
    text += fmt::format("{} {}", image.camera_id, image.name);
    for (const double value : {q.w, q.x, q.y, q.z, t.x, t.y, t.z})
      text += fmt::format(" {:.17g}", value);
  }
  return text;
}

// RT-Splatting's scenes say which pixels are glass or semi-transparent: by hand, with SAM 2.
void find_transparent_masks(const fs::path& folder, std::vector<ViewSource>& views) {
  const fs::path masks = folder / "transparent_masks";
  if (!is_folder(masks)) return;
  for (ViewSource& view : views)
    view.truth["glass"] = masks / fs::path(view.name).filename().replace_extension(".png");
}

SceneIndex index_folder(const fs::path& folder, const LoadOptions& options) {
  const fs::path files = find_colmap_model(folder);
  const ColmapModel model = read_colmap_model(files.empty() ? folder / "sparse/0" : files);
  SceneIndex index;
  index.name = folder_name(folder);
  index.dataset = "colmap";
  for (const ColmapImage& image : model.images) {
    std::string where = fmt::format("{}: image {}", files.string(), image.name);
    try {
      index.views.push_back(make_view(model, image, folder, where));
    } catch (const Error& error) {
      index.problems.push_back(make_finding("camera-field", where, error.what()));
    }
  }
  find_transparent_masks(folder, index.views);
  index.split_rule = split_views(files / "test.txt", options.test_every, index.views);
  sort_naturally(index.views);
  shorten_names(index.views);
  index.points = find_colmap_points(files);
  index.spec_hash = hash_of_files(model_text(model), index.views);
  return index;
}

}  // namespace

GLINT_REGISTER(
    LoaderSpec,
    indexed_loader(
        "colmap", match, index_folder, "sparse/0/cameras and images (.bin or .txt), images/"
    )
)

}  // namespace glint
