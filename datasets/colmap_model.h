// SPDX-License-Identifier: MIT
// COLMAP's sparse model: cameras, images and points3D, as .bin (little-endian) or .txt. World to
// camera, OpenCV axes, pixel centres at +0.5, quaternions (w, x, y, z). Tracks and observations are
// passed over. Readers never trust a count: it is checked against what is left of the file.
// Errors (kBadReference): missing, cut-off or damaged files; the message names file and entry.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/files.h"
#include "glint/scene/camera.h"
#include "glint/scene/surfels.h"

namespace glint {

// Models by id, in COLMAP's order.
struct ColmapLens {
  std::string_view name;
  std::size_t num_params;
};
inline constexpr ColmapLens kColmapLenses[] = {
    {"SIMPLE_PINHOLE", 3},
    {"PINHOLE", 4},
    {"SIMPLE_RADIAL", 4},
    {"RADIAL", 5},
    {"OPENCV", 8},
    {"OPENCV_FISHEYE", 8},
    {"FULL_OPENCV", 12},
    {"FOV", 5},
    {"SIMPLE_RADIAL_FISHEYE", 4},
    {"RADIAL_FISHEYE", 5},
    {"THIN_PRISM_FISHEYE", 12}};
inline constexpr int kColmapPinhole = 1;  // fx fy cx cy

struct ColmapCamera {
  int lens = kColmapPinhole;  // index of kColmapLenses
  std::uint64_t width = 0, height = 0;
  std::vector<double> params;
};

struct ColmapImage {
  std::uint32_t id = 0, camera_id = 0;
  std::string name;
  Vec4<double> rotation_cam_from_world{1, 0, 0, 0};
  Vec3d translation_cam_from_world{};
};

// World to camera; quaternions in files are as long as their digits.
Mat3d rotation_of(const ColmapImage& image);

struct ColmapModel {
  std::map<std::uint32_t, ColmapCamera> cameras;
  std::vector<ColmapImage> images;  // as in the file
};

// sparse/0, sparse or colmap/sparse/0 below `folder`, the first that has cameras and images; empty:
// none.
fs::path find_colmap_model(const fs::path& folder);
// cameras and images there; .bin where there are both.
ColmapModel read_colmap_model(const fs::path& model);
// points3D.bin, .txt or .ply there; empty: none, also where the file holds no point.
fs::path find_colmap_points(const fs::path& model);
// points3D.bin or .txt, by extension.
PointCloud read_colmap_points(const fs::path& path);

// All three files, as .bin and as .txt; 17 digits. Points have no track, and an error of -1, which
// is COLMAP's "unknown". Colours in 8 bits.
void write_colmap_model(const fs::path& model, const ColmapModel& data, const PointCloud& points);

}  // namespace glint
