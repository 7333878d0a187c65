// SPDX-License-Identifier: MIT
// Depth carried between views, of a wall behind bars that are thinner than a pixel: what one view
// meets between its samples the other does not, and nothing is wrong with that.
#include "datasets/check_geometry.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/scene/camera.h"

using namespace glint;

namespace {

constexpr double kBars = 2, kWall = 4;  // planes z = const in the world, metres

Camera camera_at_x(double x, ImageSize size) {
  Camera camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = camera.fy = 0.7 * size.width;
  camera.cx = 0.5 * size.width;
  camera.cy = 0.5 * size.height;
  camera.translation_cam_from_world = {-x, 0, 0};
  return camera;
}

// Bars of `width` metres, 0.31 m apart, in front of the wall; width 0: none.
Image depth_map(const Camera& camera, double width) {
  constexpr double kSpacing = 0.31;
  Image depth(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const double at = camera.center().x + kBars * camera.ray_in_cam(x + 0.5, y + 0.5).x;
      const double beside = at - kSpacing * std::floor(at / kSpacing);
      depth.at(x, y) = static_cast<float>(beside < width ? kBars : kWall);
    }
  return depth;
}

DepthAgreement agreement_of(const std::vector<Camera>& cameras, const std::vector<Image>& maps) {
  DepthAgreement agreement;
  for (std::size_t i = 0; i + 1 < cameras.size(); ++i) {
    agreement.add_pair(cameras[i], maps[i], cameras[i + 1], maps[i + 1]);
    agreement.add_pair(cameras[i + 1], maps[i + 1], cameras[i], maps[i]);
  }
  return agreement;
}

std::vector<Camera> row_of_cameras(ImageSize size) {
  std::vector<Camera> cameras;
  for (int i = 0; i < 5; ++i) cameras.push_back(camera_at_x(0.17 * i, size));
  return cameras;
}

}  // namespace

TEST_CASE("bars thinner than a pixel stand in front of nothing that a map knows") {
  for (const ImageSize size : {ImageSize{32, 18}, ImageSize{64, 36}, ImageSize{160, 90}}) {
    const std::vector<Camera> cameras = row_of_cameras(size);
    const double pixel = kBars / cameras[0].fx;  // metres, at the bars
    for (const double share : {0.0, 0.2, 0.5, 0.9}) {
      INFO(size.width << " x " << size.height << ", bars of " << share << " pixels");
      std::vector<Image> maps;
      for (const Camera& camera : cameras) maps.push_back(depth_map(camera, share * pixel));
      const DepthAgreement agreement = agreement_of(cameras, maps);
      CHECK(agreement.num_tested(DepthKind::kPlanar) > 200);
      CHECK(agreement.share_in_front(DepthKind::kPlanar) == 0);
      CHECK(agreement.median_error(DepthKind::kPlanar) < 1e-6);
    }
  }
}

TEST_CASE("a surface that the other view looks through stands in front of what it sees") {
  const ImageSize size{64, 36};
  const Camera near_camera = camera_at_x(0, size), far_camera = camera_at_x(0.2, size);
  Image near_map(size.width, size.height, 1, 2.0f), far_map(size.width, size.height, 1, 4.0f);
  DepthAgreement near_in_far, far_in_near;
  near_in_far.add_pair(near_camera, near_map, far_camera, far_map);
  far_in_near.add_pair(far_camera, far_map, near_camera, near_map);
  CHECK(near_in_far.num_tested(DepthKind::kPlanar) > 500);
  CHECK(near_in_far.share_in_front(DepthKind::kPlanar) == 1);
  CHECK(far_in_near.num_tested(DepthKind::kPlanar) > 500);
  CHECK(far_in_near.share_in_front(DepthKind::kPlanar) == 0);  // may be hidden
}

TEST_CASE("a slanted wall agrees exactly, whatever the sizes of the two maps") {
  const auto wall = [](const Camera& camera) {  // z = 3 + 0.4 x in the world
    Image depth(camera.width, camera.height, 1);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const double slope = camera.ray_in_cam(x + 0.5, y + 0.5).x;
        const double origin = camera.center().x;
        depth.at(x, y) = static_cast<float>((3 + 0.4 * origin) / (1 - 0.4 * slope));
      }
    return depth;
  };
  const Camera fine = camera_at_x(0, {200, 112}), coarse = camera_at_x(0.5, {64, 36});
  const Image fine_map = wall(fine), coarse_map = wall(coarse);
  DepthAgreement agreement;
  agreement.add_pair(fine, fine_map, coarse, coarse_map);
  agreement.add_pair(coarse, coarse_map, fine, fine_map);
  CHECK(agreement.num_tested(DepthKind::kPlanar) > 500);
  CHECK(agreement.share_in_front(DepthKind::kPlanar) == 0);
  CHECK(agreement.median_error(DepthKind::kPlanar) < 1e-6);
  CHECK(agreement.best() == DepthKind::kPlanar);
}
