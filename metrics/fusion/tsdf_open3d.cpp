// SPDX-License-Identifier: MIT
// libglint_tsdf.so: Open3D's scalable TSDF volume, whose meshes have the same bytes every time.
#include <omp.h>
#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/pipelines/integration/ScalableTSDFVolume.h>
#include <open3d/pipelines/integration/UniformTSDFVolume.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "metrics/fusion/tsdf_volume.h"

namespace glint {
namespace {

namespace o3d = open3d;

o3d::geometry::Image depth_image(ImageView depth) {
  o3d::geometry::Image image;
  image.Prepare(depth.width, depth.height, 1, sizeof(float));
  std::memcpy(image.data_.data(), depth.data, image.data_.size());
  return image;
}

// 8 bits a channel, rounded; mid-grey without a picture.
o3d::geometry::Image color_image(ImageView rgb, ImageSize size) {
  o3d::geometry::Image image;
  image.Prepare(size.width, size.height, 3, 1);
  if (rgb.empty())
    std::fill(image.data_.begin(), image.data_.end(), std::uint8_t{128});
  else
    for (std::size_t i = 0; i < image.data_.size(); ++i)
      image.data_[i] =
          static_cast<std::uint8_t>(std::lround(std::clamp(rgb.data[i], 0.0f, 1.0f) * 255.0f));
  return image;
}

Eigen::Matrix4d cam_from_world(const Camera& camera) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  const Vec3d t = camera.translation_cam_from_world;
  const double translation[3] = {t.x, t.y, t.z};
  for (int r = 0; r < 3; ++r) {
    const Vec3d row = camera.rotation_cam_from_world.rows[r];
    matrix.row(r) << row.x, row.y, row.z, translation[r];
  }
  return matrix;
}

Vec3f to_vec(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

class Open3dVolume final : public TsdfVolume {
 public:
  explicit Open3dVolume(const TsdfVolumeOptions& options)
      : volume_(
            options.voxel,
            options.truncation,
            o3d::pipelines::integration::TSDFVolumeColorType::RGB8,
            options.block
        ) {
    // Open3D opens a parallel region for every small block: with two threads they wait longer for
    // each other than they work, and on a busy machine ten times as long.
    // Open3D asks OpenMP for its number only where this variable is set, else the machine.
    ::setenv("OMP_NUM_THREADS", "1", 0);
    omp_set_num_threads(1);
  }

  void integrate(ImageView depth, ImageView rgb, const Camera& c, int depth_stride) override {
    volume_.depth_sampling_stride_ = depth_stride;
    const o3d::geometry::RGBDImage image(color_image(rgb, c.size()), depth_image(depth));
    // Open3D's pixel centres are whole numbers.
    const o3d::camera::PinholeCameraIntrinsic intrinsic(
        c.width, c.height, c.fx, c.fy, c.cx - 0.5, c.cy - 0.5
    );
    volume_.Integrate(image, intrinsic, cam_from_world(c));
  }

  TriangleMesh extract() const override {
    const auto mesh = volume_.ExtractTriangleMesh();
    TriangleMesh result;
    for (const auto& vertex : mesh->vertices_) result.vertices.push_back(to_vec(vertex));
    for (const auto& color : mesh->vertex_colors_) result.colors.push_back(to_vec(color));
    for (const auto& face : mesh->triangles_)
      result.faces.push_back({face.x(), face.y(), face.z()});
    return result;
  }

  std::size_t bytes_per_voxel() const override { return sizeof(o3d::geometry::TSDFVoxel); }

 private:
  mutable o3d::pipelines::integration::ScalableTSDFVolume volume_;  // extraction is not const
};

}  // namespace
}  // namespace glint

extern "C" __attribute__((visibility("default"))) glint::TsdfVolume* glint_make_tsdf_volume(
    const glint::TsdfVolumeOptions& options
) {
  return new glint::Open3dVolume(options);
}
