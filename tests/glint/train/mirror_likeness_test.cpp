// SPDX-License-Identifier: MIT
// How well a pane explains photos, beside what k_s alone explains.
#include "glint/train/mirror_likeness.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{60, 48};

// A view that shows nothing without mirrored rays, k_s between 0.1 and 0.9.
struct Fixture {
  View view;
  KnownView known{&view, {}, Image(60, 48, 3), random_map(kSize, 1, 0.1f, 0.9f, 1)};
  Image seen{60, 48, 1, 1.0f};
  Image mirrored = random_map(kSize, 3, 0, 1, 2);  // mirrored left to right

  Fixture() {
    view.camera.width = kSize.width, view.camera.height = kSize.height;
    view.rgb = Image(kSize.width, kSize.height, 3);
  }
  // k_s times what is mirrored there.
  void photograph(const Image& what) {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        put3(
            view.rgb.pixel(x, y),
            0,
            known.share.at(x, y) * get3(what.pixel(kSize.width - 1 - x, y), 0)
        );
  }
  double likeness() const {
    PaneLikeness pane;
    pane.add(known, seen, mirrored);
    return pane.partial_correlation();
  }
};

}  // namespace

TEST_CASE("A pane whose camera sees what photos have left explains all of it") {
  Fixture f;
  f.photograph(f.mirrored);
  CHECK(f.likeness() == Approx(1));
}

TEST_CASE("What k_s alone explains is no likeness") {
  Fixture f;
  f.photograph(random_map(kSize, 3, 0, 1, 7));  // of another room
  CHECK(std::abs(f.likeness()) < 0.05);
  f.photograph(Image(kSize.width, kSize.height, 3, 0.5f));
  CHECK(f.likeness() == 0);  // k_s explains it all
}

TEST_CASE("The partial correlation is that of what linear fits to k_s leave") {
  Fixture f;
  f.photograph(f.mirrored);
  Image noise = random_map(kSize, 3, 0, 0.3f, 5);
  for (std::size_t i = 0; i < noise.values().size(); ++i) f.view.rgb.data()[i] += noise.data()[i];
  // One window alone, so that there is one mean.
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      if (x >= 16 || y >= 16) f.seen.at(x, y) = 0;
  std::vector<double> values[3];
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const Vec3f left = get3(f.view.rgb.pixel(x, y), 0);
      const Vec3f m = get3(f.mirrored.pixel(kSize.width - 1 - x, y), 0);
      const auto share = static_cast<double>(f.known.share.at(x, y));
      values[0].push_back(static_cast<double>(left.x + left.y + left.z));
      values[1].push_back(share * static_cast<double>(m.x + m.y + m.z));
      values[2].push_back(share);
    }
  const auto without_mean = [](std::vector<double>& v) {
    double mean = 0;
    for (const double x : v) mean += x / static_cast<double>(v.size());
    for (double& x : v) x -= mean;
  };
  const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  };
  for (auto& v : values) without_mean(v);
  for (int k = 0; k < 2; ++k) {
    const double slope = product(values[k], values[2]) / product(values[2], values[2]);
    for (std::size_t i = 0; i < values[k].size(); ++i) values[k][i] -= slope * values[2][i];
  }
  const double expected = product(values[0], values[1]) /
                          std::sqrt(product(values[0], values[0]) * product(values[1], values[1]));
  CHECK(f.likeness() == Approx(expected).epsilon(1e-4));
}
