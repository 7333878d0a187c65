// SPDX-License-Identifier: MIT
// The reference renderer itself, against hand-computed numbers and closed forms.
#include "tests/support/reference_render.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/facing_layers.h"
#include "tests/support/golden_surfel.h"
#include "tests/support/gradcheck.h"

using namespace glint;
using namespace glint::test;

namespace {

// A surfel parallel to the image plane, on the axis of a centred camera at the origin.
void add_facing(ReferenceInput& input, double depth, double scale, double opacity, double feature) {
  input.count += 1;
  input.channels = 1;
  for (const double value : {0.0, 0.0, depth}) input.means.push_back(value);
  for (const double value : {scale, scale}) input.scales.push_back(value);
  for (const double value : {1.0, 0.0, 0.0, 0.0}) input.rotations.push_back(value);
  input.opacities.push_back(opacity);
  input.features.push_back(feature);
}

enum class Quantity { kRho3, kDepth, kRho2 };

// A quantity of the golden surfel's hit as a function of (mean, quaternion, scales).
double golden_quantity(const std::vector<double>& parameters, Quantity quantity) {
  ReferenceInput input = golden_reference_input();
  input.means.assign(parameters.begin(), parameters.begin() + 3);
  input.rotations.assign(parameters.begin() + 3, parameters.begin() + 7);
  input.scales.assign(parameters.begin() + 7, parameters.end());
  const ReferenceSurfel surfel = reference_surfel(input, 0, golden_camera());
  const ReferenceHit hit = reference_hit(surfel, golden_camera(), kGoldenPoint);
  return quantity == Quantity::kRho3 ? hit.rho3 : quantity == Quantity::kDepth ? hit.t : hit.rho2;
}

void check_golden_gradient(Quantity quantity, const GoldenGradient& expected) {
  const std::vector<double> at = {0.2, -0.1, 4, 0.9, 0.2, -0.3, 0.1, 0.3, 0.15};
  const std::vector<double> gradient = central_differences(
      [&](const std::vector<double>& x) { return golden_quantity(x, quantity); }, at
  );
  std::vector<double> all(expected.mean.begin(), expected.mean.end());
  all.insert(all.end(), expected.rotation.begin(), expected.rotation.end());
  all.insert(all.end(), expected.scale.begin(), expected.scale.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    INFO("parameter " << i);
    // Seven decimals are printed.
    CHECK(gradient[i] == Approx(all[i]).epsilon(1e-7).margin(1e-7));
  }
}

}  // namespace

TEST_CASE("The reference renderer reproduces the golden example") {
  const ReferenceInput exact = golden_reference_input();
  const ReferenceSurfel surfel = reference_surfel(exact, 0, golden_camera());
  CHECK(surfel.box_center.x == Approx(333.7065171687).epsilon(1e-11));
  CHECK(surfel.box_center.y == Approx(225.0454528077).epsilon(1e-11));
  CHECK(surfel.box_half_extent.x == Approx(89.0076125791).epsilon(1e-11));
  CHECK(surfel.box_half_extent.y == Approx(50.0653632793).epsilon(1e-11));
  CHECK(surfel.normal_in_cam.x == Approx(0.5263158).epsilon(1e-7));
  CHECK(surfel.normal_in_cam.y == Approx(0.4421053).epsilon(1e-7));
  CHECK(surfel.normal_in_cam.z == Approx(-0.7263158).epsilon(1e-7));

  const ReferenceHit hit = reference_hit(surfel, golden_camera(), kGoldenPoint);
  CHECK(hit.u == Approx(0.2904346194).epsilon(1e-9));
  CHECK(hit.v == Approx(0.1056436893).epsilon(1e-9));
  CHECK(hit.t == Approx(4.0581995682).epsilon(1e-9));
  CHECK(hit.rho3 == Approx(0.0955128572).epsilon(1e-9));
  CHECK(hit.rho2 == Approx(765.894).epsilon(1e-6));
  CHECK_FALSE(hit.low_pass());

  const ReferenceRenderer renderer(exact, golden_camera(), RasterSettings{});
  CHECK(renderer.pixel(352, 230).alpha == Approx(0.7626927772).epsilon(1e-9));
}

TEST_CASE("Central differences of the reference reproduce the golden derivatives") {
  SECTION("rho3") { check_golden_gradient(Quantity::kRho3, kGoldenRho3); }
  SECTION("depth") { check_golden_gradient(Quantity::kDepth, kGoldenDepth); }
  SECTION("rho2") { check_golden_gradient(Quantity::kRho2, kGoldenRho2); }
}

TEST_CASE("A surfel that faces the camera has a Gaussian profile cut off at three sigma") {
  ReferenceInput input;
  add_facing(input, 2, 0.4, 0.8, 1);  // sigma 4 pixels
  const ReferenceOutput output = reference_render(input, small_camera(), RasterSettings{});
  for (int x = 0; x < 21; ++x) {
    const double sigmas = (x - 10) / 4.0;
    CHECK(output.at(x, 10).alpha == Approx(0.8 * std::exp(-0.5 * sigmas * sigmas)));
    CHECK(output.at(x, 10).depth_sum == Approx(2 * output.at(x, 10).alpha));
    CHECK(output.at(x, 10).normal.z == Approx(-output.at(x, 10).alpha));
  }
  CHECK(output.at(0, 0).alpha == 0.0);  // 3.5 sigma
  CHECK(output.at(10, 10).depth_median == 2.0);
  CHECK(output.at(0, 0).depth_median == 0.0);
}

TEST_CASE("The low-pass keeps a surfel far smaller than a pixel visible") {
  ReferenceInput input;
  add_facing(input, 2, 1e-5, 0.8, 1);
  const ReferenceOutput output = reference_render(input, small_camera(), RasterSettings{});
  CHECK(output.at(11, 10).alpha == Approx(0.8 * std::exp(-1.0)));  // rho2 = 2 at one pixel
  CHECK(output.at(12, 10).alpha == Approx(0.8 * std::exp(-4.0)));
  CHECK(output.at(13, 10).alpha == 0.0);  // rho2 = 18 > 9
}

TEST_CASE("Surfels composite front to back whatever their order in the input") {
  ReferenceInput input;
  add_facing(input, 4, 8, 0.5, 10);
  add_facing(input, 2, 4, 0.4, 1);
  const ReferencePixel pixel = reference_render(input, small_camera(), RasterSettings{}).at(10, 10);
  CHECK(pixel.features[0] == Approx(0.4 * 1 + 0.6 * 0.5 * 10));
  CHECK(pixel.alpha == Approx(0.7));
  CHECK(pixel.depth_sum == Approx(0.4 * 2 + 0.3 * 4));
  CHECK(pixel.depth_median == 4.0);  // met at transmittance 0.6
  // m = far / (far - near) (1 - near / z)
  const double m_difference = 100 / 99.8 * 0.2 * (1 / 2.0 - 1 / 4.0);
  CHECK(pixel.distortion == Approx(0.4 * 0.3 * m_difference * m_difference));
}

TEST_CASE("The median depth is that of the surfel which brings the transmittance to one half") {
  ReferenceInput input;
  add_facing(input, 2, 4, 0.6, 1);
  add_facing(input, 4, 8, 0.6, 1);
  CHECK(reference_render(input, small_camera(), RasterSettings{}).at(10, 10).depth_median == 2.0);
}

TEST_CASE("Nothing is added once the transmittance would fall below its limit") {
  ReferenceInput input;
  for (int i = 0; i < 4; ++i) add_facing(input, 2 + i, 8, 1, 1);  // alpha clamped to 0.99
  const ReferencePixel pixel = reference_render(input, small_camera(), RasterSettings{}).at(10, 10);
  CHECK(pixel.weights.size() == 2);  // 1e-2, 1e-4 (just above in double), then stop
  CHECK(pixel.cutoffs.transmittance < 1e-9);
}

TEST_CASE("Hits at or before the near plane and the near limit do not count") {
  ReferenceInput input;
  add_facing(input, 0.19, 1, 0.5, 1);
  add_facing(input, 1, 4, 0.5, 10);
  add_facing(input, 3, 9, 0.5, 100);
  const RasterSettings settings;
  CHECK(reference_render(input, small_camera(), settings).at(10, 10).features[0] == Approx(30));
  const Image limit(21, 21, 1, 1.0f);
  input.near_limit = limit;
  CHECK(reference_render(input, small_camera(), settings).at(10, 10).features[0] == Approx(50));
}

TEST_CASE("The reference reports how near a pixel is to each cut-off") {
  ReferenceInput input;
  add_facing(input, 2, 0.4, 0.495, 1);
  const ReferenceOutput output = reference_render(input, small_camera(), RasterSettings{});
  // In the middle rho = 0 and z = 2 are far from 9 and 0.2; opacity is half the clamp.
  CHECK(output.at(10, 10).cutoffs.clamp == Approx(0.5));
  CHECK(output.at(10, 10).cutoffs.accept == Approx(1.0));
  CHECK(output.at(10, 10).cutoffs.median == Approx(1.0));
  CHECK(output.at(10, 10).cutoffs.order == Cutoffs::kNone);
  // (0, 4): 10 and 6 pixels off the middle, rho = (100 + 36) / 16 = 8.5
  CHECK(output.at(0, 4).cutoffs.accept == Approx(1 - 8.5 / 9));
}
