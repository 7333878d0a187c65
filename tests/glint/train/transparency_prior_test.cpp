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

TEST_CASE("The transparency prior has the gradient of its differences") {
  const ImageSize size{8, 6};
  const Image image = random_map<float>(size, 3, 0, 1, 31);
  const ImageD t = random_map<double>(size, 1, 0.05f, 0.95f, 32);
  check_loss_gradient(t, loss_with(image));
  check_loss_gradient(t, loss_with(image, {0, 1, 3, 5}));
  check_loss_gradient(t, loss_with(image, {2, 0, 0}));
}

TEST_CASE("The transparency prior does not depend on the number of threads") {
  const ImageSize size{45, 67};
  check_thread_independence(
      random_map<float>(size, 1, 0, 1, 33), loss_with(random_map<float>(size, 3, 0, 1, 34))
  );
}
