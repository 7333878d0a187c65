// SPDX-License-Identifier: MIT
// Which pixels share a mirrored ray, what they show, and that the way back is the transpose.
#include "glint/render/shared_rays.h"

#include <map>
#include <numeric>

#include "glint/core/error.h"
#include "glint/core/rng.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr RaySharing kSharing{.below = 0.2f};

// Little is mirrored but on the right half; the second row is glass; all normals are alike.
GlassBuffer buffer_of(ImageSize size) {
  GlassBuffer b;
  b.depth = Image(size.width, size.height, 1, 2.0f);
  b.transparency = b.specularity = Image(size.width, size.height, 1, 0.1f);
  b.normal = b.reflected.origins = b.reflected.directions = Image(size.width, size.height, 3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      if (x >= size.width / 2) b.specularity.at(x, y) = 0.3f;
      if (y == 1) b.transparency.at(x, y) = 0.9f;
      b.normal.at(x, y, 2) = -1;
      b.reflected.directions.at(x, y, 0) = 1 + static_cast<float>(x + 100 * y);
    }
  return b;
}

bool has_ray(const Rays& rays, std::size_t i) { return rays.directions.data()[3 * i] != 0; }

double dot_of(const Image& a, const Image& b) {
  return std::inner_product(a.values().begin(), a.values().end(), b.values().begin(), 0.0);
}

}  // namespace

TEST_CASE("Pixels that mirror little share the ray of one of 2x2, others keep their own") {
  const ImageSize size{8, 4};
  const GlassBuffer buffer = buffer_of(size);
  SharedRays shared;
  for (int step = 0; step < 20; ++step) {
    const Rays& rays = shared.choose(buffer, kSharing, step);
    int traced = 0;
    for (std::size_t i = 0; i < size.num_pixels(); ++i) {
      const bool weak = buffer.specularity.data()[i] < 0.2f && buffer.transparency.data()[i] < 0.5f;
      if (!weak) CHECK(has_ray(rays, i));
      if (weak) traced += has_ray(rays, i);
      if (has_ray(rays, i))
        CHECK(rays.directions.data()[3 * i] == buffer.reflected.directions.data()[3 * i]);
    }
    // Rows 0 and 2, 3 of the left half: two blocks each, where the leader may be glass.
    CHECK(traced >= 2);
    CHECK(traced <= 4);
  }
}

TEST_CASE("Every pixel of a block is its leader in as many of the steps, whatever the view") {
  const ImageSize size{2, 2};
  GlassBuffer buffer = buffer_of(size);
  buffer.specularity.array().fill(0.1f);
  buffer.transparency.array().fill(0.0f);
  SharedRays shared;
  for (const int views : {1, 4, 56}) {  // steps between two of the same view
    std::vector<int> led(size.num_pixels());
    for (int k = 0; k < 400; ++k) {
      const Rays& rays = shared.choose(buffer, kSharing, k * views);
      for (std::size_t i = 0; i < led.size(); ++i) led[i] += has_ray(rays, i);
    }
    CHECK(std::accumulate(led.begin(), led.end(), 0) == 400);
    for (const int count : led) CHECK(std::abs(count - 100) < 40);
  }
}

TEST_CASE("No ray is shared across an edge, nor with a pixel that hit nothing, nor without asking"
) {
  const ImageSize size{2, 2};
  GlassBuffer buffer = buffer_of(size);
  buffer.specularity.array().fill(0.1f);
  buffer.transparency.array().fill(0.0f);
  SharedRays shared;
  const auto num_rays = [&](const RaySharing& sharing, int step) {
    const Rays& rays = shared.choose(buffer, sharing, step);
    int count = 0;
    for (std::size_t i = 0; i < 4; ++i) count += has_ray(rays, i);
    return count;
  };
  CHECK(num_rays(kSharing, 0) == 1);
  CHECK(num_rays({}, 0) == 4);
  // Another wall.
  buffer.normal.at(1, 0, 2) = 0;
  buffer.normal.at(1, 0, 0) = -1;
  for (int step = 0; step < 20; ++step) {
    const int count = num_rays(kSharing, step);
    CHECK((count == 2 || count == 4));
  }
}

TEST_CASE("Pixels show what their ray met, and its gradient is the sum of theirs") {
  const ImageSize size = GENERATE(ImageSize{8, 4}, ImageSize{7, 5}, ImageSize{1, 1});
  const GlassBuffer buffer = buffer_of(size);
  SharedRays shared;
  for (int step = 0; step < 8; ++step) {
    const Rays& rays = shared.choose(buffer, kSharing, step);
    const Image traced = random_map(size, 3, -1, 1, 1), dL_dcolor = random_map(size, 3, -1, 1, 2);
    Image color, dL_dtraced;
    shared.spread(traced, color);
    shared.spread_vjp(dL_dcolor, dL_dtraced);
    CHECK(dot_of(color, dL_dcolor) == Approx(dot_of(traced, dL_dtraced)));
    for (std::size_t i = 0; i < size.num_pixels(); ++i) {
      if (has_ray(rays, i)) CHECK(color.data()[3 * i] == traced.data()[3 * i]);
      if (!has_ray(rays, i)) CHECK(dL_dtraced.data()[3 * i] == 0);
    }
  }
}

TEST_CASE("Sharing gives the same on every backend") {
  check_same_as_cpu(1e-7, [] {
    const ImageSize size{33, 17};
    const GlassBuffer buffer = buffer_of(size);
    SharedRays shared;
    std::map<std::string, std::vector<float>> found;
    const Rays& rays = shared.choose(buffer, kSharing, 3);
    found["directions"] = read(rays.directions);
    Image color, dL_dtraced;
    shared.spread(random_map(size, 3, -1, 1, 1), color);
    shared.spread_vjp(random_map(size, 3, -1, 1, 2), dL_dtraced);
    found["color"] = read(color);
    found["dL_dtraced"] = read(dL_dtraced);
    return found;
  });
}
