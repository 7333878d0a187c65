// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include <cmath>

#include "glint/train/trainable_set.h"
#include "reports/show/viewer/surfel_drawing.h"

using namespace glint;

namespace {

constexpr int kSide = 64;

Camera camera_in_front() {
  Camera camera;
  camera.width = camera.height = kSide;
  camera.fx = camera.fy = kSide;
  camera.cx = camera.cy = kSide / 2.0;
  return camera;
}

// A surfel that faces the camera at (x, 0, z), of this radius and grey.
void add_disc(
    SurfelCloud& cloud, float x, float z, float radius, float grey, float opacity = 0.9f
) {
  const std::size_t i = cloud.size();
  cloud.resize(i + 1);
  put3(cloud.means.data(), i, {x, 0, z});
  for (std::size_t axis = 0; axis < 2; ++axis)
    cloud.log_scales.data()[2 * i + axis] = std::log(radius);
  cloud.rotations.data()[4 * i] = 1;
  cloud.opacity_logits.data()[i] = logit(opacity);
  const float dc = (grey - 0.5f) / kSh0;
  put3(cloud.sh_dc.data(), i, {dc, dc, dc});
}

MapSet drawn(const SurfelCloud& cloud, SurfelStyle style, std::optional<CutPlane> cut = {}) {
  TrainableSet set(cloud);
  return draw_surfels({{"interface", &set}}, camera_in_front(), style, cut);
}

}  // namespace

TEST_CASE("a disc is a circle of one standard deviation") {
  SurfelCloud cloud;
  add_disc(cloud, 0, 2, 0.5f, 0.8f);
  const MapSet maps = drawn(cloud, SurfelStyle::kDiscs);
  const double radius = kSide * 0.5 / 2;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double r = std::hypot(x + 0.5 - kSide / 2.0, y + 0.5 - kSide / 2.0);
      if (std::abs(r - radius) < 0.1) continue;
      CHECK((maps["depth"].at(x, y) > 0) == (r < radius));
    }
  const int middle = kSide / 2;
  CHECK(maps["depth"].at(middle, middle) == Approx(2));
  CHECK(maps["rgb"].at(middle, middle, 1) == Approx(0.8f));  // seen from the front
  CHECK(maps["normal"].at(middle, middle, 2) == Approx(-1));
}

TEST_CASE("the nearer surfel is seen, whatever the order") {
  SurfelCloud near_first, far_first;
  for (SurfelCloud* cloud : {&near_first, &far_first}) {
    const bool first = cloud == &near_first;
    add_disc(*cloud, 0, first ? 2 : 4, 0.5f, first ? 0.2f : 0.9f);
    add_disc(*cloud, 0, first ? 4 : 2, 0.5f, first ? 0.9f : 0.2f);
  }
  const MapSet a = drawn(near_first, SurfelStyle::kDiscs),
               b = drawn(far_first, SurfelStyle::kDiscs);
  CHECK(a["rgb"].at(kSide / 2, kSide / 2) == Approx(0.2f));
  CHECK(std::equal(a["rgb"].values().begin(), a["rgb"].values().end(), b["rgb"].values().begin()));
}

TEST_CASE("points are as wide at any distance") {
  for (const float z : {1.0f, 8.0f}) {
    SurfelCloud cloud;
    add_disc(cloud, 0, z, 0.5f, 0.8f);
    const MapSet maps = drawn(cloud, SurfelStyle::kPoints);
    int pixels = 0;
    for (const float depth : maps["depth"].values()) pixels += depth > 0;
    CHECK(pixels == 16);  // the centre lies where four pixels meet
  }
}

TEST_CASE("faint surfels, those behind the camera and what is cut are not drawn") {
  const auto seen = [](const MapSet& maps) {
    for (const float depth : maps["depth"].values())
      if (depth > 0) return true;
    return false;
  };
  SurfelCloud faint, behind, cloud;
  add_disc(faint, 0, 2, 0.5f, 0.8f, 0.01f);
  add_disc(behind, 0, -2, 0.5f, 0.8f);
  add_disc(cloud, 0, 2, 0.5f, 0.8f);
  CHECK_FALSE(seen(drawn(faint, SurfelStyle::kDiscs)));
  CHECK_FALSE(seen(drawn(behind, SurfelStyle::kDiscs)));
  CHECK_FALSE(seen(drawn(behind, SurfelStyle::kPoints)));
  CHECK(seen(drawn(cloud, SurfelStyle::kDiscs, CutPlane{{0, 0, 1}, 2.1})));
  CHECK_FALSE(seen(drawn(cloud, SurfelStyle::kDiscs, CutPlane{{0, 0, 1}, 1.9})));
}
