// SPDX-License-Identifier: MIT
#include "glint/train/photometric.h"

#include "metrics/ssim.h"
#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

Image photo(ImageSize size, std::uint64_t seed) { return random_map(size, 3, 0.1f, 0.9f, seed); }

// The loss in double, straight from its definition: no separable filter, no tricks.
double loss_by_definition(const Image& x, const Image& y, PhotometricWeights weights) {
  const std::array<double, kSsimTaps> w = ssim_window<double>();
  double l1 = 0, ssim = 0;
  for (int c = 0; c < 3; ++c)
    for (int row = 0; row < x.height(); ++row)
      for (int col = 0; col < x.width(); ++col) {
        double m[5] = {};
        for (int j = -kSsimRadius; j <= kSsimRadius; ++j)
          for (int i = -kSsimRadius; i <= kSsimRadius; ++i) {
            if (col + i < 0 || row + j < 0 || col + i >= x.width() || row + j >= x.height())
              continue;
            const double weight = w[i + kSsimRadius] * w[j + kSsimRadius];
            const double a = static_cast<double>(x.at(col + i, row + j, c));
            const double b = static_cast<double>(y.at(col + i, row + j, c));
            const double terms[5] = {a, b, a * a, b * b, a * b};
            for (int k = 0; k < 5; ++k) m[k] += weight * terms[k];
          }
        ssim += ssim_from_moments(m[0], m[1], m[2], m[3], m[4]);
        l1 += std::abs(
            static_cast<double>(x.at(col, row, c)) - static_cast<double>(y.at(col, row, c))
        );
      }
  const double count = 3.0 * static_cast<double>(x.num_pixels());
  return static_cast<double>(weights.l1) * l1 / count +
         static_cast<double>(weights.ssim) * (1 - ssim / count);
}

}  // namespace

TEST_CASE("The photometric loss equals its definition at sizes around the window and the lanes") {
  for (const ImageSize size : {ImageSize{3, 2}, {8, 11}, {19, 13}, {33, 7}}) {
    const Image x = photo(size, 1), y = photo(size, 2);
    Image gradient(size.width, size.height, 3);
    const PhotometricWeights weights{0.8f, 0.2f};
    const PhotometricTerms terms = PhotometricLoss().evaluate(x, y, weights, gradient);
    CHECK(terms.weighted(weights) == Approx(loss_by_definition(x, y, weights)).margin(2e-6));
  }
}

TEST_CASE("The gradient of the photometric loss matches central differences of the definition") {
  Image x = photo({17, 12}, 1);
  const Image y = photo({17, 12}, 2);
  Image gradient(17, 12, 3);
  const PhotometricWeights weights{0.8f, 0.2f};
  PhotometricLoss().evaluate(x, y, weights, gradient);
  const auto value = [&] { return loss_by_definition(x, y, weights); };
  check_slopes(x, gradient, value, {1.0f / 1024, 2e-3, 2e-6}, 5);
}

TEST_CASE("Identical images have no loss, and the gradient is added, not assigned") {
  const Image x = photo({20, 20}, 1);
  Image gradient(20, 20, 3, 5.0f);
  const PhotometricTerms terms = PhotometricLoss().evaluate(x, x, {}, gradient);
  CHECK(terms.l1 == 0.0);
  CHECK(terms.mse == 0.0);
  CHECK(terms.ssim_loss == Approx(0.0).margin(1e-6));
  for (const float value : gradient.values()) CHECK(value == Approx(5.0f).margin(1e-6));
}

TEST_CASE("The photometric loss has the same bytes with one and two threads") {
  const Image x = photo({50, 41}, 1), y = photo({50, 41}, 2);
  const auto evaluated = [&] {
    Image gradient(50, 41, 3);
    const PhotometricTerms terms = PhotometricLoss().evaluate(x, y, {}, gradient);
    return std::pair(terms.ssim_loss, gradient);
  };
  const auto one = with_threads(1, evaluated), two = with_threads(2, evaluated);
  CHECK(one.first == two.first);
  CHECK(same_bytes(one.second, two.second));
}

TEST_CASE("Images of different size are refused") {
  Image gradient(4, 4, 3);
  CHECK_THROWS_AS(PhotometricLoss().evaluate(Image(4, 4, 3), Image(5, 4, 3), {}, gradient), Error);
}

TEST_CASE("Pixels that do not count are right: no loss of theirs, no gradient, in windows neither"
) {
  const Image y = photo({17, 12}, 2);
  Image x = photo({17, 12}, 1), counted(17, 12, 1, 1.0f), gradient(17, 12, 3, 5.0f);
  for (int row = 3; row < 9; ++row)
    for (int col = 4; col < 11; ++col) counted.at(col, row) = 0;
  const auto with_photo = [&](const Image& image) {
    Image picture = image;
    for (std::size_t i = 0; i < picture.values().size(); ++i)
      if (counted.data()[i / 3] == 0) picture.data()[i] = y.data()[i];
    return picture;
  };
  const PhotometricWeights weights{0.8f, 0.2f};
  const PhotometricTerms terms = PhotometricLoss().evaluate(x, {y, counted}, weights, gradient);
  CHECK(
      terms.weighted(weights) == Approx(loss_by_definition(with_photo(x), y, weights)).margin(2e-6)
  );
  double squared = 0;
  for (std::size_t i = 0; i < x.values().size(); ++i)
    squared += std::pow(static_cast<double>(with_photo(x).data()[i] - y.data()[i]), 2);
  CHECK(terms.mse == Approx(squared / (3 * (17 * 12 - 6 * 7))));
  for (std::size_t i = 0; i < x.values().size(); ++i) {
    gradient.data()[i] -= 5;
    if (counted.data()[i / 3] == 0) CHECK(gradient.data()[i] == 0.0f);
  }
  const auto value = [&] { return loss_by_definition(with_photo(x), y, weights); };
  check_slopes(x, gradient, value, {1.0f / 1024, 2e-3, 3e-6}, 5);
}
