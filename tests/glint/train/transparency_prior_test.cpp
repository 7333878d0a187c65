// SPDX-License-Identifier: MIT
#include "glint/train/transparency_prior.h"

#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

auto loss_with(const Image& image, TransparencyPriorLoss options = {}) {
  return [=](const auto& t, auto weight, auto& gradient) {
    return options.evaluate(t, image, weight, gradient);
  };
}

}  // namespace

TEST_CASE("The transparency prior is entropy, mean and edge-aware smoothness") {
  const Image t = map_of<float>(2, 1, 1, {0.5f, 0.25f});
  const Image image = map_of<float>(2, 1, 3, {0, 0, 0, 0.3f, 0.3f, 0.3f});
  const double entropy = (std::log(2.0) + 0.25 * std::log(4.0) + 0.75 * std::log(4.0 / 3)) / 2;
  CHECK(value_of(loss_with(image, {1, 0, 0}), t) == Approx(entropy));
  CHECK(value_of(loss_with(image, {0, 1, 0}), t) == Approx(0.375));
  CHECK(value_of(loss_with(image, {0, 0, 1}), t) == Approx(0.25 * std::exp(-0.3) / 2));
  CHECK(value_of(loss_with(image, {0, 0, 1, 4}), t) == Approx(0.25 * std::exp(-1.2) / 2));
  CHECK(
      value_of(loss_with(image, {2, 3, 4}), t) ==
      Approx(2 * entropy + 3 * 0.375 + 4 * 0.125 * std::exp(-0.3))
  );
}

TEST_CASE("An opaque map costs nothing") {
  CHECK(value_of(loss_with(Image(5, 4, 3)), Image(5, 4, 1)) == Approx(0).margin(2e-5));
}
