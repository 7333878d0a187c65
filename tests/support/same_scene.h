// SPDX-License-Identifier: MIT
// Two scenes, bit for bit.
#pragma once

#include <catch2/catch.hpp>
#include <cstring>

#include "datasets/view_maps.h"
#include "glint/scene/scene.h"
#include "tests/support/same_bytes.h"

namespace glint::test {

template <class T>
bool same_bytes(const T* a, const T* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(T)) == 0;
}

inline void check_same(const View& a, const View& b) {
  INFO(a.name);
  CHECK(a.name == b.name);
  CHECK(a.camera.size() == b.camera.size());
  CHECK(same_bytes(&a.camera.fx, &b.camera.fx, 4));
  CHECK(same_bytes(&a.camera.rotation_cam_from_world, &b.camera.rotation_cam_from_world, 1));
  CHECK(same_bytes(&a.camera.translation_cam_from_world, &b.camera.translation_cam_from_world, 1));
  std::vector<const Image*> maps;
  for_each_map(b, [&](const std::string&, const Image& map, const MapRow&) {
    maps.push_back(&map);
  });
  std::size_t i = 0;
  for_each_map(a, [&](const std::string& name, const Image& map, const MapRow&) {
    INFO(name);
    CHECK(same_bytes(map, *maps[i++]));
  });
}

inline void check_same(const std::vector<View>& a, const std::vector<View>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) check_same(a[i], b[i]);
}

inline void check_same(const Scene& a, const Scene& b) {
  CHECK(a.name == b.name);
  CHECK(a.dataset == b.dataset);
  CHECK(a.spec_hash == b.spec_hash);
  CHECK(a.simulated_priors == b.simulated_priors);
  check_same(a.train, b.train);
  check_same(a.test, b.test);
  CHECK(same_bytes(a.points.positions, b.points.positions));
  CHECK(same_bytes(a.points.colors, b.points.colors));
  CHECK(same_bytes(a.points.normals, b.points.normals));
  CHECK(same_bytes(&a.bounds_min, &b.bounds_min, 1));
  CHECK(same_bytes(&a.bounds_max, &b.bounds_max, 1));
  CHECK(same_bytes(&a.spatial_scale, &b.spatial_scale, 1));
}

}  // namespace glint::test
