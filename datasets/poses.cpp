// SPDX-License-Identifier: MIT
// The plainest folder that holds a capture: a picture and a matrix for each view, as ScanNet's and
// 7-Scenes' tools leave them.
//   images/<name>.{png,jpg}   poses/<name>.txt   4x4, camera to world, OpenCV axes
//   intrinsics.txt            3x3 or 4x4, of all views; or intrinsics/<name>.txt of each
//   points.ply                may be missing
// Numbers stand apart by blanks and line ends. A pose that is not finite (ScanNet's for lost
// frames) leaves its view out.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include "datasets/dataset.h"
#include "datasets/scene_index.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr std::size_t kMostNumbers = 16;

bool has_intrinsics(const fs::path& folder) {
  return is_there(folder / "intrinsics.txt") || is_folder(folder / "intrinsics");
}

LoaderMatch match(const fs::path& folder) {
  if (!is_folder(folder / "poses")) return {};
  if (!is_folder(folder / "images") || !has_intrinsics(folder)) return {Sureness::kName, "poses"};
  return {Sureness::kContents, "images, poses and intrinsics"};
}

double number_of(const std::string& word, const fs::path& path) {
  std::string lower = word;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  if (lower == "inf" || lower == "-inf" || lower == "nan" || lower == "-nan") return std::nan("");
  double value = 0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  GLINT_CHECK(
      read.ec == std::errc{} && read.ptr == word.data() + word.size(),
      kBadReference,
      "{}: '{}' is no number; expected a matrix",
      path.string(),
      word
  );
  return value;
}

// A matrix of 9 or 16 numbers as 4x4.
std::array<double, 16> read_matrix(const fs::path& path) {
  std::vector<double> values;
  std::istringstream words(read_text(path));
  for (std::string word; words >> word && values.size() <= kMostNumbers;)
    values.push_back(number_of(word, path));
  GLINT_CHECK(
      values.size() == 9 || values.size() == kMostNumbers,
      kBadReference,
      "{}: {} numbers, expected 9 (3x3) or 16 (4x4)",
      path.string(),
      values.size() > kMostNumbers ? "more than 16" : std::to_string(values.size())
  );
  const std::size_t width = values.size() == 9 ? 3 : 4;
  std::array<double, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  for (std::size_t i = 0; i < values.size(); ++i) matrix[i / width * 4 + i % width] = values[i];
  return matrix;
}

void read_intrinsics(const fs::path& folder, const std::string& stem, Camera& camera) {
  const fs::path own = folder / "intrinsics" / (stem + ".txt");
  const auto k = read_matrix(is_there(own) ? own : folder / "intrinsics.txt");
  camera.fx = k[0], camera.cx = k[2];
  camera.fy = k[5], camera.cy = k[6];
}

// False: the pose is not finite.
bool read_pose(const fs::path& path, Camera& camera) {
  const auto m = read_matrix(path);
  if (!std::all_of(m.begin(), m.end(), [](double v) { return std::isfinite(v); })) return false;
  GLINT_CHECK(
      m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] == 1,
      kBadReference,
      "{}: its last row is {} {} {} {}, expected 0 0 0 1: the camera's position belongs into the "
      "last column (is it transposed?)",
      path.string(),
      m[12],
      m[13],
      m[14],
      m[15]
  );
  // R of the camera has the axes of the matrix as its rows.
  camera.rotation_cam_from_world = {{{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}}};
  camera.translation_cam_from_world = -(camera.rotation_cam_from_world * Vec3d{m[3], m[7], m[11]});
  return true;
}

// Adds the view of a picture, or why there is none.
void add_view(const fs::path& folder, const fs::path& picture, SceneIndex& index) {
  const std::string stem = picture.stem().string();
  const fs::path pose = folder / "poses" / (stem + ".txt");
  ViewSource view;
  view.name = picture.filename().string();
  view.image = picture;
  view.where = pose.string();
  try {
    if (!read_pose(pose, view.camera)) {
      index.remarks.push_back({"lost-pose", view.where, "not finite; its view is left out"});
      return;
    }
    read_intrinsics(folder, stem, view.camera);
    index.views.push_back(std::move(view));
  } catch (const Error& error) {
    index.problems.push_back(make_finding("camera-field", pose.string(), error.what()));
  }
}

SceneIndex index_folder(const fs::path& folder, const LoadOptions& options) {
  SceneIndex index;
  index.name = folder_name(folder);
  index.dataset = "poses";
  std::string text;
  for (const fs::path& picture : list_files(folder / "images", kPictureExtensions)) {
    add_view(folder, picture, index);
    for (const char* part : {"poses", "intrinsics"})
      if (const fs::path file = folder / part / (picture.stem().string() + ".txt"); is_there(file))
        text += read_file(file);
  }
  sort_naturally(index.views);
  index.split_rule = split_every(index.views, options.test_every);
  shorten_names(index.views);
  if (is_there(folder / "points.ply")) index.points = folder / "points.ply";
  if (is_there(folder / "intrinsics.txt")) text += read_file(folder / "intrinsics.txt");
  index.spec_hash = hash_of_files(text, index.views);
  return index;
}

}  // namespace

GLINT_REGISTER(
    LoaderSpec, indexed_loader("poses", match, index_folder, "images/, poses/ and intrinsics.txt")
)

}  // namespace glint
