// SPDX-License-Identifier: MIT
#include "glint/train/normal_smoothness.h"

#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

auto loss_with(const Image& image, float edge_sharpness = 1) {
  return [=](const auto& normal, auto weight, auto& gradient) {
    return NormalSmoothnessLoss{edge_sharpness}.evaluate(normal, image, weight, gradient);
  };
}

// Two pixels whose unit normals differ by (1, 0, 1), of different lengths.
const std::vector<float> kTwoNormals{0, 0, -0.5f, 0.25f, 0, 0};

}  // namespace

TEST_CASE("Smoothness is the L1 difference of the unit normals, less across an image edge") {
  const std::vector<float> colors{0.2f, 0.4f, 0.6f, 0.8f, 0.4f, 0.3f};  // mean contrast 0.3
  for (const ImageSize size : {ImageSize{2, 1}, ImageSize{1, 2}}) {
    const Image normal = map_of<float>(size.width, size.height, 3, kTwoNormals);
    const Image image = map_of<float>(size.width, size.height, 3, colors);
    CHECK(value_of(loss_with(Image(size.width, size.height, 3)), normal) == Approx(2.0 / 2));
    CHECK(value_of(loss_with(image), normal) == Approx(std::exp(-0.3)));
    CHECK(value_of(loss_with(image, 10), normal) == Approx(std::exp(-3.0)));
  }
}

TEST_CASE("Equal directions of any length are smooth") {
  const Image normal = map_of<float>(2, 1, 3, {0, 0, -1, 0, 0, -0.25f});
  CHECK(value_of(loss_with(Image(2, 1, 3)), normal) == 0);
}

TEST_CASE("Differences with a pixel without normal do not count") {
  const Image normal = map_of<float>(3, 1, 3, {0, 0, -1, 0, 0, 0, 1, 0, 0});
  check_no_loss(normal, loss_with(Image(3, 1, 3)));
}
