// SPDX-License-Identifier: MIT
#include "metrics/lpips_formula.h"

#include "tests/support/check_vjp.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kChannels = 5;
const std::vector<double> kReference = {0.5, 0.0, 2.0, 0.25, 1.0};
const std::vector<double> kLin = {0.1, 0.7, 0.0, 0.3, 1.5};

double tap_of(const Vector& a) {
  return lpips_tap<double>(a.data(), kReference.data(), kLin.data(), kChannels);
}

}  // namespace

TEST_CASE("LPIPS at a pixel is the weighted squared distance of unit vectors") {
  // 3-4-5: (0.6, 0.8) against (1, 0).
  const double a[] = {3, 4}, b[] = {7, 0}, lin[] = {2, 3};
  CHECK(lpips_tap<double>(a, b, lin, 2) == Approx(2 * 0.16 + 3 * 0.64).epsilon(1e-9));
  CHECK(lpips_tap<double>(a, a, lin, 2) == 0);
}

TEST_CASE("LPIPS at a pixel does not look at the length of features") {
  const Vector a = random_inputs(kChannels, 0.1, 2, 1);
  Vector longer = a;
  for (double& value : longer) value *= 100;
  CHECK(tap_of(longer) == Approx(tap_of(a)).epsilon(1e-8));
}

TEST_CASE("LPIPS at a pixel: the gradient is that of central differences") {
  for (const std::uint64_t seed : {1, 2, 3})
    check_vjp(
        random_inputs(kChannels, 0.1, 2, seed),
        [](const Vector& a) { return Vector{tap_of(a)}; },
        [](const Vector& a, const Vector& g) {
          Vector dL_da(kChannels, 0.0);
          lpips_tap_vjp<double>(
              a.data(), kReference.data(), kLin.data(), kChannels, g[0], dL_da.data()
          );
          return dL_da;
        }
    );
}

TEST_CASE("LPIPS at a pixel adds to the gradient, which is finite where nothing fires") {
  const Vector zero(kChannels, 0.0);
  Vector dL_da(kChannels, 1.0);
  lpips_tap_vjp<double>(zero.data(), zero.data(), kLin.data(), kChannels, 1.0, dL_da.data());
  CHECK(dL_da == Vector(kChannels, 1.0));
  lpips_tap_vjp<double>(zero.data(), kReference.data(), kLin.data(), kChannels, 1.0, dL_da.data());
  for (const double value : dL_da) CHECK(std::isfinite(value));
}

TEST_CASE("LPIPS is fed what the published scaling layer gives") {
  for (int c = 0; c < 3; ++c) {
    const LpipsInput symmetric = lpips_input(true, c), unit = lpips_input(false, c);
    const double black = (-1 - kLpipsShift[c]) / kLpipsScale[c];
    const double white = (1 - kLpipsShift[c]) / kLpipsScale[c];
    CHECK(static_cast<double>(symmetric.offset) == Approx(black));
    CHECK(static_cast<double>(symmetric.gain + symmetric.offset) == Approx(white));
    CHECK(static_cast<double>(unit.gain + unit.offset) == Approx(white));
    CHECK(static_cast<double>(unit.offset) == Approx(-kLpipsShift[c] / kLpipsScale[c]));
  }
}
