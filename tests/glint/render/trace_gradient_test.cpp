// SPDX-License-Identifier: MIT
// The float backward pass of trace() against central differences of the brute-force tracer in
// double, for every parameter, ray origin and ray direction. Tolerance as in
// rasterize_gradient_test.cpp.
#include <catch2/catch.hpp>
#include <functional>

#include "tests/support/gradcheck.h"
#include "tests/support/reference_trace.h"
#include "tests/support/trace_arrays.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr double kTolerance = 1e-3;
constexpr double kStepGuard = 1e-2;  // rays nearer to a jump get no weight

struct Case : TraceArrays {
  Rays rays;
  TraceSettings settings;
  TraceOutputGradient dL_doutput;
};

Case random_case(std::uint64_t seed) {
  Rng rng(seed);
  Case c;
  for (int i = 0; i < 14; ++i) {
    const double size = log_uniform(rng, 0.3, 0.8);
    c.surfels.add(
        uniform(rng, 0, 1) * random_direction(rng),
        {size, size * uniform(rng, 0.7, 1.4)},
        random_unit_quaternion(rng),
        uniform(rng, 0.2, 0.9),
        {0, 0, 0}
    );
    for (int k = 0; k < 3; ++k) c.sh_dc.push_back(rng.uniform(-1, 1));
    for (int k = 0; k < 45; ++k) c.sh_rest.push_back(0.3f * rng.uniform(-1, 1));
  }
  c.rays = {Image(8, 6, 3), Image(8, 6, 3)};
  for (float& value : c.rays.origins.values()) value = rng.uniform(-1, 1);
  for (float& value : c.rays.directions.values()) value = rng.uniform(-1, 1);
  const ReferenceTraceInput reference = reference_trace_input(c.view(), c.rays);
  c.dL_doutput = {Image(8, 6, 3), Image(8, 6, 1), Image(8, 6, 1), Image(8, 6, 3)};
  int clean = 0;
  for (std::size_t i = 0; i < 48; ++i) {
    const bool use = reference_trace(reference, i, c.settings).nearest_cutoff > kStepGuard;
    clean += use;
    const float weight = use ? 1.0f : 0.0f;
    for (std::size_t k = 0; k < 3; ++k) {
      c.dL_doutput.color.data()[3 * i + k] = weight * rng.uniform(-1, 1);
      c.dL_doutput.normal.data()[3 * i + k] = weight * rng.uniform(-1, 1);
    }
    c.dL_doutput.alpha.data()[i] = weight * rng.uniform(-1, 1);
    c.dL_doutput.depth_sum.data()[i] = weight * rng.uniform(-1, 1);
  }
  REQUIRE(clean > 15);
  return c;
}

double loss(const Case& c, const ReferenceTraceInput& input) {
  double sum = 0;
  for (std::size_t i = 0; i < input.num_rays(); ++i) {
    const ReferenceRay ray = reference_trace(input, i, c.settings);
    const auto weight = [&](const Image& image, std::size_t at) {
      return static_cast<double>(image.data()[at]);
    };
    for (int k = 0; k < 3; ++k) {
      const std::size_t at = 3 * i + static_cast<std::size_t>(k);
      sum += weight(c.dL_doutput.color, at) * ray.color[k];
      sum += weight(c.dL_doutput.normal, at) * ray.normal[k];
    }
    sum += weight(c.dL_doutput.alpha, i) * ray.alpha;
    sum += weight(c.dL_doutput.depth_sum, i) * ray.depth_sum;
  }
  return sum;
}

void check(
    const Case& c,
    std::span<const float> actual,
    std::vector<double> ReferenceTraceInput::*field,
    const char* name
) {
  ReferenceTraceInput reference = reference_trace_input(c.view(), c.rays);
  const auto f = [&](const std::vector<double>& x) {
    reference.*field = x;
    return loss(c, reference);
  };
  const std::vector<double> expected = central_differences(f, reference.*field);
  const GradientError error = gradient_error<float>(actual, expected);
  INFO(name << ", worst at " << error.worst_index);
  CHECK(error.norm > 0);
  CHECK(error.distance <= kTolerance * error.norm);
}

}  // namespace

TEST_CASE("every gradient of trace matches central differences") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Case c = random_case(seed);
    Tracer tracer;
    const TraceOutput out = tracer.forward({c.view(), c.rays, c.settings});
    const TraceGradient g = tracer.backward(c.dL_doutput);
    INFO("seed " << seed);
    check(c, g.means, &ReferenceTraceInput::means, "means");
    check(c, g.scales, &ReferenceTraceInput::scales, "scales");
    check(c, g.rotations, &ReferenceTraceInput::rotations, "rotations");
    check(c, g.opacities, &ReferenceTraceInput::opacities, "opacities");
    check(c, g.sh_dc, &ReferenceTraceInput::sh_dc, "sh_dc");
    check(c, g.sh_rest, &ReferenceTraceInput::sh_rest, "sh_rest");
    std::vector<float> rays;
    for (std::size_t i = 0; i < 48; ++i)
      for (const Image* image : {&g.rays.origins, &g.rays.directions})
        for (std::size_t k = 0; k < 3; ++k) rays.push_back(image->data()[3 * i + k]);
    check(c, rays, &ReferenceTraceInput::rays, "rays");
  }
}

TEST_CASE("visibility sums to alpha, and the densification statistic is half the depth") {
  const Case c = random_case(4);
  Tracer tracer;
  TraceOutput out = tracer.forward({c.view(), c.rays, c.settings});
  TraceGradient g = tracer.backward(c.dL_doutput);
  double visible = 0, alpha = 0;
  for (const float value : g.visibility) visible += static_cast<double>(value);
  for (const float value : out.alpha.values()) alpha += static_cast<double>(value);
  CHECK(visible == Approx(alpha).epsilon(1e-5));

  // One surfel and one ray at t = 2: half_depths is the gradient of the mean itself.
  Case one;
  one.surfels.add({0.1, 0.1, 2}, {0.5, 0.5}, {1, 0, 0, 0}, 0.5, {0, 0, 0});
  one.sh_dc = {1, 1, 1};
  one.sh_rest.assign(45, 0.0f);
  one.rays = {Image(1, 1, 3), Image(1, 1, 3)};
  one.rays.directions.data()[2] = 1;
  one.dL_doutput.color = Image(1, 1, 3, 1.0f);
  out = tracer.forward({one.view(), one.rays, {}});
  g = tracer.backward(one.dL_doutput);
  CHECK(g.means[0] != 0.0f);
  for (int k = 0; k < 3; ++k) CHECK(g.half_depths[k] == Approx(g.means[k]).margin(1e-9));
}
