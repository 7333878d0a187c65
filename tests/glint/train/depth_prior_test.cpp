// SPDX-License-Identifier: MIT
#include "glint/train/depth_prior.h"

#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{11, 9};

auto loss_with(const Image& prior, const Image& weights = {}, DepthPriorLoss options = {}) {
  return [prior, weights, options](const auto& depth, auto weight, auto& gradient) {
    return options.evaluate(depth, prior, weights, weight, gradient);
  };
}

// A prior with holes, and weights that leave some pixels out.
Image test_prior() {
  Image prior = random_map<float>(kSize, 1, 0.2f, 0.9f, 1);
  prior.at(2, 3) = prior.at(10, 8) = 0;
  return prior;
}
Image test_weights() {
  Image weights = random_map<float>(kSize, 1, 0.1f, 1, 2);
  weights.at(5, 5) = weights.at(0, 0) = 0;
  return weights;
}
ImageD test_depth() {
  ImageD depth = random_map<double>(kSize, 1, 2, 4, 3);
  depth.at(7, 1) = -1;  // no depth, and further than a difference's step from becoming one
  return depth;
}
template <class T, class F>
BasicImage<T> mapped(BasicImage<T> map, const F& f) {
  for (T& value : map.values()) value = f(value);
  return map;
}

}  // namespace

TEST_CASE("The depth loss of three pixels is that of the fitted line") {
  // Line 1.5 z - 2/3; residuals -1/6, 1/3, -1/6.
  const Image prior = map_of<float>(3, 1, 1, {1, 2, 4});
  const ImageD depth = map_of<double>(3, 1, 1, {1, 2, 3});
  const DepthPriorFit fit = fit_depth_prior(depth, prior, {});
  CHECK(fit.valid);
  CHECK(fit.scale == Approx(1.5));
  CHECK(fit.shift == Approx(-2.0 / 3));
  CHECK(value_of(loss_with(prior), depth) == Approx(1.0 / 18));
  const ImageD gradient = gradient_of(loss_with(prior), depth);
  CHECK(gradient.at(0, 0) == Approx(2 * 1.5 * (-1.0 / 6) / 3));
  CHECK(gradient.at(1, 0) == Approx(2 * 1.5 * (1.0 / 3) / 3));
}

TEST_CASE("Gradient matching adds each scale's differences over its own number of pixels") {
  const Image prior = map_of<float>(3, 1, 1, {1, 2, 4});
  const ImageD depth = map_of<double>(3, 1, 1, {1, 2, 3});
  // Residuals differ by 1/2 and -1/2 at stride 1 (3 pixels), by 0 at stride 2.
  CHECK(value_of(loss_with(prior, {}, {1, 0.5f}), depth) == Approx(1.0 / 18 + 0.5 / 3));
  CHECK(value_of(loss_with(prior, {}, {4, 1}), depth) == Approx(1.0 / 18 + 1.0 / 3));
  // The same in a column: y is matched as x is.
  const Image column_prior = map_of<float>(1, 3, 1, {1, 2, 4});
  const ImageD column = map_of<double>(1, 3, 1, {1, 2, 3});
  CHECK(value_of(loss_with(column_prior, {}, {4, 1}), column) == Approx(1.0 / 18 + 1.0 / 3));
}

TEST_CASE("Gradient matching does not join the end of a row to the next row's start") {
  // Rows of equal residuals up to sign: the only differences are in y.
  const Image prior = map_of<float>(2, 2, 1, {1, 2, 2, 3});
  const ImageD depth = map_of<double>(2, 2, 1, {1, 2, 1, 2});
  // Line z + 1/2; residuals 1/2, 1/2, -1/2, -1/2: |differences| in y 1 + 1, in x 0, over 4 pixels.
  CHECK(value_of(loss_with(prior, {}, {1, 1}), depth) == Approx(0.25 + 2.0 / 4));
}

TEST_CASE("A prior's scale multiplies the depth loss by its square, a shift changes nothing") {
  const ImageD depth = test_depth();
  const Image prior = test_prior();
  // A power of two and sums of 24 bits: no rounding but at the shift, 6e-8 of a prior near 1.
  const Image moved = mapped(prior, [](float p) { return p > 0 ? 2 * p + 0.5f : 0; });
  const double value = value_of(loss_with(prior), depth);
  CHECK(value > 1e-3);
  CHECK(value_of(loss_with(moved), depth) == Approx(4 * value).epsilon(1e-5));
}

TEST_CASE("Scaling and shifting the depth does not change its loss, nor does the gradient do either"
) {
  const auto loss = loss_with(test_prior(), test_weights(), {4, 1});
  const ImageD depth = test_depth();
  const ImageD moved = mapped(depth, [](double z) { return z > 0 ? 3 * z + 1 : 0; });
  CHECK(value_of(loss, moved) == Approx(value_of(loss, depth)).epsilon(1e-12));
  // So the gradient is orthogonal to both motions.
  const ImageD gradient = gradient_of(loss, depth);
  double along_shift = 0, along_scale = 0, norm = 0;
  for (std::size_t i = 0; i < depth.num_pixels(); ++i) {
    along_shift += gradient.data()[i];
    along_scale += gradient.data()[i] * depth.data()[i];
    norm += std::abs(gradient.data()[i]);
  }
  CHECK(std::abs(along_shift) < 1e-12 * norm);
  CHECK(std::abs(along_scale) < 1e-12 * norm);
}

TEST_CASE("An affine prior gives no depth loss") {
  const ImageD depth = map_of<double>(4, 1, 1, {1, 2, 4, 3});
  const Image prior = map_of<float>(4, 1, 1, {0.5f, 0.75f, 1.25f, 1});
  CHECK(value_of(loss_with(prior, {}, {4, 1}), depth) == Approx(0).margin(1e-14));
}

TEST_CASE("Pixels without depth, prior or weight do not count") {
  const Image prior = map_of<float>(6, 1, 1, {1, 2, 4, 0, 9, 7});
  const Image depth = map_of<float>(6, 1, 1, {1, 2, 3, 5, 0, 6});
  const Image weights = map_of<float>(6, 1, 1, {1, 1, 1, 1, 1, 0});
  const auto loss = loss_with(prior, weights);
  CHECK(value_of(loss, depth) == Approx(1.0 / 18));
  const Image gradient = gradient_of(loss, depth);
  for (int x = 3; x < 6; ++x) CHECK(gradient.at(x, 0) == 0.0f);
}

TEST_CASE("Without a prior, with one pixel, and with constant depth there is no depth loss") {
  const Image depth = map_of<float>(3, 1, 1, {1, 2, 3});
  check_no_loss(depth, loss_with({}));
  check_no_loss(depth, loss_with(map_of<float>(3, 1, 1, {0, 2, 0}), {}, {4, 1}));
  check_no_loss(Image(3, 1, 1, 2.7f), loss_with(map_of<float>(3, 1, 1, {1, 2, 4}), {}, {4, 1}));
  check_no_loss(depth, loss_with(Image(3, 1, 1, 0.0f)));
}

TEST_CASE("A depth prior of another size is refused") {
  CHECK_THROWS_AS(value_of(loss_with(Image(2, 1, 1, 1.0f)), Image(3, 1, 1, 1.0f)), Error);
}
