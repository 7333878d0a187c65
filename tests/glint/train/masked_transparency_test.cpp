// SPDX-License-Identifier: MIT
#include "glint/train/masked_transparency.h"

#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

auto loss_with(const Image& image, const TransparencyMasks& masks, float late) {
  return [=](const auto& t, auto weight, auto& gradient) {
    return MaskedTransparencyLoss().evaluate(t, masks, image, {late}, weight, gradient);
  };
}
double entropy(double t) { return -t * std::log(t) - (1 - t) * std::log(1 - t); }

}  // namespace

TEST_CASE("The masked prior is the entropy where labels speak, t where opaque, a hinge on glass") {
  const Image image(3, 1, 3), t = map_of<float>(3, 1, 1, {0.5f, 0.5f, 0.5f});
  TransparencyMasks masks;
  masks.transparent = map_of<float>(3, 1, 1, {1, 0, 0});
  masks.opaque = map_of<float>(3, 1, 1, {0, 1, 0});
  CHECK(value_of(loss_with(image, masks, 0), t) == Approx(entropy(0.5) + 0.5));
  CHECK(value_of(loss_with(image, masks, 1), t) == Approx(3 * 0.5 + 0.3 * 0.3));
  CHECK(value_of(loss_with(image, masks, 0.5f), t) == Approx(0.5 * entropy(0.5) + 1 + 0.5 * 0.09));
}

TEST_CASE("Without labels only the smoothness of t is left") {
  const Image image(2, 1, 3), t = map_of<float>(2, 1, 1, {0.5f, 0.25f});
  CHECK(value_of(loss_with(image, {}, 0), t) == Approx(0.125));
}
