// SPDX-License-Identifier: MIT
#include "datasets/known_surfaces.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/check_geometry.h"
#include "glint/core/error.h"
#include "glint/core/kd_tree.h"
#include "glint/core/parallel.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr std::size_t kMostPoints = 40000;
constexpr std::size_t kNeighbors = 10;  // the point itself among them

// The normal of the plane through the points; nothing where they are no sheet.
std::optional<Vec3d> plane_normal(std::span<const Vec3d> points) {
  constexpr double kThin = 0.05;  // squared extents, of the next larger one
  Vec3d mean{};
  for (const Vec3d& point : points) mean += (1.0 / static_cast<double>(points.size())) * point;
  cv::Matx33d covariance = cv::Matx33d::zeros();
  for (const Vec3d& point : points)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) covariance(i, j) += (point - mean)[i] * (point - mean)[j];
  cv::Vec3d extents;
  cv::Matx33d axes;  // rows, the largest extent first
  cv::eigen(covariance, extents, axes);
  if (!(extents[2] < kThin * extents[1]) || !(extents[1] > kThin * extents[0])) return std::nullopt;
  return Vec3d{axes(2, 0), axes(2, 1), axes(2, 2)};
}

std::vector<Vec3f> sample_points(const fs::path& file) {
  std::vector<Vec3f> points, sampled;
  try {
    points = read_points(file).positions;
  } catch (const OutOfMemory&) {
    throw;
  } catch (const Error&) {
    return {};  // loading and checking name it
  }
  const std::size_t step = points.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < points.size(); i += step)
    if (std::isfinite(length(points[i]))) sampled.push_back(points[i]);
  return sampled.size() < 2 * kNeighbors ? std::vector<Vec3f>{} : sampled;
}

struct SeenPoint {
  std::size_t id;
  Vec3d cam;
  Vec2d pixel;
};

// The nearest depth around each place of an image: hidden points lie behind it.
class NearestDepth {
 public:
  NearestDepth(const std::vector<SeenPoint>& points, ImageSize size)
      : size_(size),
        cells_(cells_for(points.size())),
        depth_(static_cast<std::size_t>(cells_ * cells_), kFar) {
    for (const SeenPoint& point : points) {
      double& nearest = depth_[cell(column(point), row(point))];
      nearest = std::min(nearest, point.cam.z);
    }
  }

  // Of the point's cell and those beside it.
  double around(const SeenPoint& point) const {
    double nearest = kFar;
    for (int y = row(point) - 1; y <= row(point) + 1; ++y)
      for (int x = column(point) - 1; x <= column(point) + 1; ++x)
        if (x >= 0 && y >= 0 && x < cells_ && y < cells_)
          nearest = std::min(nearest, depth_[cell(x, y)]);
    return nearest;
  }

 private:
  static constexpr double kFar = 1e30;

  // In each direction, so that a cell has a few points.
  static int cells_for(std::size_t num_points) {
    constexpr double kPointsOfCell = 4;
    const double cells = std::sqrt(static_cast<double>(num_points) / kPointsOfCell);
    return std::clamp(static_cast<int>(cells), 1, 48);
  }

  int column(const SeenPoint& p) const {
    return static_cast<int>(p.pixel.x * cells_ / size_.width);
  }
  int row(const SeenPoint& p) const { return static_cast<int>(p.pixel.y * cells_ / size_.height); }
  std::size_t cell(int x, int y) const { return static_cast<std::size_t>(y * cells_ + x); }

  ImageSize size_;
  int cells_;  // in each direction
  std::vector<double> depth_;
};

Vec3d facing(Vec3d normal, Vec3d point) { return dot(normal, point) > 0 ? -1.0 * normal : normal; }

}  // namespace

KnownPoints::KnownPoints(const fs::path& file) {
  if (!file.empty()) points_ = sample_points(file);
  normals_.resize(points_.size());
  if (!points_.empty()) find_normals();
}

void KnownPoints::find_normals() {
  const PointsAdaptor adaptor{points_};
  const KdTree tree(3, adaptor);
  parallel_for(points_.size(), 256, [&](std::size_t i) {
    const double query[3] = {
        adaptor.kdtree_get_pt(i, 0), adaptor.kdtree_get_pt(i, 1), adaptor.kdtree_get_pt(i, 2)};
    std::uint32_t ids[kNeighbors];
    double squared[kNeighbors];
    tree.knnSearch(query, kNeighbors, ids, squared);
    std::array<Vec3d, kNeighbors> around;
    for (std::size_t n = 0; n < kNeighbors; ++n) around[n] = cast<double>(points_[ids[n]]);
    normals_[i] = plane_normal(around);
  });
}

std::vector<KnownPixel> KnownPoints::seen_by(const Camera& camera) const {
  constexpr double kNear = 1.15;  // times the nearest depth around
  std::vector<SeenPoint> seen;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec3d cam = camera.to_cam(cast<double>(points_[i]));
    if (!(cam.z > 1e-6)) continue;
    const Vec2d pixel = camera.project(cam);
    if (pixel.x >= 0 && pixel.y >= 0 && pixel.x < camera.width && pixel.y < camera.height)
      seen.push_back({i, cam, pixel});
  }
  const NearestDepth nearest(seen, camera.size());
  std::vector<KnownPixel> pixels;
  for (const SeenPoint& point : seen) {
    if (point.cam.z > kNear * nearest.around(point)) continue;
    KnownPixel pixel{static_cast<int>(point.pixel.x), static_cast<int>(point.pixel.y), point.cam.z};
    if (const auto& normal = normals_[point.id])
      pixel.normal = facing(camera.rotation_cam_from_world * *normal, point.cam);
    pixels.push_back(pixel);
  }
  return pixels;
}

ImageSize picture_size(const ViewSource& view) {
  const bool stated = view.camera.width > 0 && view.camera.height > 0;
  return stated ? view.camera.size() : read_image_size(view.image);
}

std::vector<KnownPixel> known_pixels(const Camera& camera, ImageView depth) {
  const int step = std::max(1, std::max(depth.width, depth.height) / 64);
  std::vector<KnownPixel> pixels;
  for (int y = 1 + step / 2; y < depth.height - 1; y += step)
    for (int x = 1 + step / 2; x < depth.width - 1; x += step) {
      const auto z = static_cast<double>(depth.at(x, y));
      if (z > 0 && std::isfinite(z))
        pixels.push_back({x, y, z, normal_from_depth(camera, depth, x, y, DepthKind::kPlanar)});
    }
  return pixels;
}

}  // namespace glint
