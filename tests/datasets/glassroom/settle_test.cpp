// SPDX-License-Identifier: MIT
#include "datasets/glassroom/settle.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "glint/core/error.h"

using namespace glint;

namespace {

struct Case {
  ContainerShape shape;
  std::vector<ContainerObject> objects;
  SettleResult result;
};

Case settled(std::uint64_t seed, int count = 6) {
  Rng rng(seed);
  Case c;
  c.shape = random_container(rng);
  c.objects = random_objects(c.shape, count, rng);
  c.result = settle(
      c.shape, c.objects, {.support_height = 0.01f, .place = {0.1f, -0.1f}, .yaw = 0.3f}, rng
  );
  return c;
}

bool same_bytes(const Pose& a, const Pose& b) { return std::memcmp(&a, &b, sizeof(Pose)) == 0; }

// Vertices of the object in the container's frame.
Bounds bounds_in_container(const Case& c, std::size_t i) {
  Bounds bounds;
  const Pose& box = c.result.container;
  for (const Vec3f vertex : c.objects[i].mesh.vertices)
    bounds.include(
        transpose_times(box.rotation, c.result.objects[i].apply(vertex) - box.translation)
    );
  return bounds;
}

}  // namespace

TEST_CASE("Settling repeats to the bit") {
  const Case a = settled(5), b = settled(5);
  CHECK(a.result.num_steps == b.result.num_steps);
  CHECK(same_bytes(a.result.container, b.result.container));
  REQUIRE(a.result.objects.size() == b.result.objects.size());
  for (std::size_t i = 0; i < a.result.objects.size(); ++i)
    CHECK(same_bytes(a.result.objects[i], b.result.objects[i]));
}

TEST_CASE("The container stands upright on the floor") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Case c = settled(seed);
    CHECK(c.result.at_rest);
    CHECK(c.result.container.translation.z == Approx(0.01f).margin(0.003));
    CHECK(c.result.container.rotation.rows[2].z > 0.9999f);
    CHECK(
        std::hypot(
            c.result.container.translation.x - 0.1f, c.result.container.translation.y + 0.1f
        ) < 0.1f
    );
  }
}

TEST_CASE("Objects rest inside the panes, and something lies on the floor pane") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Case c = settled(seed);
    const float inner_x = 0.5f * c.shape.size.x - 0.5f * c.shape.beam;
    const float inner_y = 0.5f * c.shape.size.y - 0.5f * c.shape.beam;
    const float pane_top = 0.5f * c.shape.beam + 0.5f * c.shape.pane_thickness;
    float lowest = 10;
    for (std::size_t i = 0; i < c.objects.size(); ++i) {
      INFO(c.objects[i].name);
      const Bounds b = bounds_in_container(c, i);
      CHECK(b.low.x > -inner_x - 0.004f);
      CHECK(b.high.x < inner_x + 0.004f);
      CHECK(b.low.y > -inner_y - 0.004f);
      CHECK(b.high.y < inner_y + 0.004f);
      CHECK(b.low.z > pane_top - 0.006f);
      CHECK(b.high.z < c.shape.size.z);
      lowest = std::min(lowest, b.low.z);
    }
    CHECK(lowest < pane_top + 0.004f);
  }
}

TEST_CASE("Objects that cannot fit are reported") {
  Rng rng(1);
  ContainerShape shape{.size = {0.3f, 0.3f, 0.3f}};
  std::vector<ContainerObject> objects = random_objects({}, 6, rng);
  CHECK_THROWS_WITH(settle(shape, objects, {}, rng), Catch::Contains("no space"));
}

TEST_CASE("Frame and panes tile the container's surface") {
  const ContainerShape shape{};
  const auto beams = container_beams(shape);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    CHECK(beams[i].low.z >= 0.0f);
    CHECK(beams[i].high.z <= shape.size.z + 1e-6f);
    for (std::size_t j = 0; j < i; ++j) CHECK_FALSE(beams[i].grown(-1e-5f).overlaps(beams[j]));
  }
  for (const Pane& pane : container_panes(shape)) {
    CHECK(pane.half_size[pane.axis] == Approx(0.5f * shape.pane_thickness));
    const float rim = 0.5f * shape.size[(pane.axis + 1) % 3] - pane.half_size[(pane.axis + 1) % 3];
    CHECK(rim == Approx(shape.beam));
  }
}
