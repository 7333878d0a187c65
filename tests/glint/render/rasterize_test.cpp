// SPDX-License-Identifier: MIT
// The rasteriser's forward pass against the reference renderer, closed forms and itself.
#include "glint/render/rasterize.h"

#include <array>
#include <catch2/catch.hpp>
#include <numeric>

#include "tests/support/compare_render.h"
#include "tests/support/facing_layers.h"
#include "tests/support/forward_backward.h"
#include "tests/support/golden_surfel.h"
#include "tests/support/threads.h"

using namespace glint;
using namespace glint::test;

namespace {

// Largest difference at clean pixels. By the estimate at kCutoffGuard rho is off by 1e-4 and alpha
// by half of that; ten times as much room for slanted surfels and for depth.
constexpr double kTolerance = 1e-3;
// Where planes are seen under angles down to 0.05 degrees, that angle multiplies every rounding.
constexpr double kGrazingTolerance = 1e-2;

RasterOutput rasterize(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings = {},
    int lanes = 16
) {
  Rasterizer rasterizer;
  return rasterizer.forward({input, camera, with_lanes(settings, lanes)});
}

RasterOutput rasterize(const SurfelArrays& surfels, const Camera& camera) {
  return rasterize(surfels.view(), camera, kAllMaps);
}

void check_errors(const RenderErrors& errors, double tolerance) {
  CHECK(errors.features < tolerance);
  CHECK(errors.alpha < tolerance);
  CHECK(errors.depth_sum < tolerance);
  CHECK(errors.depth_median < tolerance);
  CHECK(errors.normal < tolerance);
  CHECK(errors.distortion < tolerance);
  CHECK(errors.plane_distance < tolerance);
  // Rounding that tips over a cut-off is far smaller than the guard: few of those near it do.
  CHECK(static_cast<double>(errors.flipped) <= 1 + 0.02 * static_cast<double>(errors.near_cutoff));
  CHECK(errors.clean > errors.near_cutoff);
}

}  // namespace

TEST_CASE("Rasterising reproduces the golden example") {
  const RasterOutput output = rasterize(golden_surfel(), golden_camera());
  const auto at = [](const Image& map, int c = 0) {
    return static_cast<double>(map.at(352, 230, c));
  };
  const double alpha = 0.7626927772;
  CHECK(at(output.alpha) == Approx(alpha).epsilon(1e-6));
  CHECK(at(output.features) == Approx(alpha).epsilon(1e-6));
  CHECK(at(output.depth_sum) == Approx(alpha * 4.0581995682).epsilon(1e-6));
  CHECK(at(output.depth_median) == Approx(4.0581995682).epsilon(1e-6));
  CHECK(at(output.normal, 0) == Approx(alpha * 0.5263158).epsilon(1e-6));
  CHECK(at(output.normal, 1) == Approx(alpha * 0.4421053).epsilon(1e-6));
  CHECK(at(output.normal, 2) == Approx(alpha * -0.7263158).epsilon(1e-6));
  CHECK(at(output.distortion) == 0);  // one hit alone
  // The plane through (0.2, -0.1, 4) with the normal above.
  const double distance = std::abs(0.2 * 0.5263158 - 0.1 * 0.4421053 - 4 * 0.7263158);
  CHECK(at(output.plane_distance) == Approx(alpha * distance).epsilon(1e-6));
}

TEST_CASE("Random scenes equal the reference at every image size") {
  struct Kind {
    const char* name;
    RandomSurfels options;
    double tolerance;
  };
  const Kind kind = GENERATE(
      Kind{"ordinary", {}, kTolerance},
      Kind{"edge on", {.edge_on = 1}, kGrazingTolerance},
      Kind{"at the camera plane", {.at_camera = 1}, kGrazingTolerance},
      Kind{"behind", {.behind = 1}, kTolerance},
      Kind{"huge", {.huge = 1}, kTolerance},
      Kind{"tiny", {.tiny = 1}, kTolerance},
      Kind{"all kinds", all_kinds(), kGrazingTolerance}
  );
  const auto [width, height] =
      GENERATE(table<int, int>({{1, 1}, {7, 5}, {33, 17}, {16, 16}, {240, 135}}));
  INFO(kind.name << ", " << width << " x " << height);
  RenderErrors total;
  for (std::uint64_t seed = 0; seed < (width > 100 ? 1u : 12u); ++seed) {
    Rng rng(seed, static_cast<std::uint64_t>(width));
    const Camera camera = random_camera(rng, {width, height});
    const SurfelArrays surfels = random_surfels(kind.options, camera, rng);
    const ReferenceRenderer reference(reference_input(surfels.view()), camera, kAllMaps);
    add_errors(total, compare_render(rasterize(surfels, camera), reference, {width, height}));
  }
  check_errors(total, kind.tolerance);
}

TEST_CASE("Any number of feature channels is composited") {
  const int channels = GENERATE(range(1, 9), 11, 16);
  INFO(channels << " channels");
  Rng rng(100 + static_cast<std::uint64_t>(channels));
  const Camera camera = random_camera(rng, {33, 17});
  const SurfelArrays surfels = random_surfels({.channels = channels}, camera, rng);
  const RasterOutput output = rasterize(surfels, camera);
  CHECK(output.features.channels() == channels);
  const ReferenceRenderer reference(reference_input(surfels.view()), camera, kAllMaps);
  check_errors(compare_render(output, reference, {33, 17}), kTolerance);
}

TEST_CASE("Only hits behind the near limit of their pixel count") {
  Rng rng(5);
  const Camera camera = random_camera(rng, {33, 17});
  const SurfelArrays surfels = random_surfels({}, camera, rng);
  Image limit(33, 17, 1);
  for (float& z : limit.values()) z = rng.uniform(0, 6);
  RasterInput input = surfels.view();
  input.near_limit = limit;
  const ReferenceRenderer reference(reference_input(input), camera, kAllMaps);
  check_errors(compare_render(rasterize(input, camera, kAllMaps), reference, {33, 17}), kTolerance);
}

TEST_CASE("A larger near plane cuts more of each surfel") {
  Rng rng(6);
  const Camera camera = random_camera(rng, {33, 17});
  const SurfelArrays surfels = random_surfels(all_kinds(), camera, rng);
  const RasterSettings settings{
      .near_plane = 2, .with_distortion = true, .distortion_far = 20, .with_plane_distance = true};
  const ReferenceRenderer reference(reference_input(surfels.view()), camera, settings);
  check_errors(
      compare_render(rasterize(surfels.view(), camera, settings), reference, {33, 17}),
      kGrazingTolerance
  );
}

TEST_CASE("Visibility is the weight a surfel has over all pixels") {
  Rng rng(7);
  const Camera camera = random_camera(rng, {33, 17});
  const SurfelArrays surfels = random_surfels(all_kinds(), camera, rng);
  const RasterOutput output = rasterize(surfels, camera);
  const ReferenceOutput reference =
      reference_render(reference_input(surfels.view()), camera, kAllMaps);
  REQUIRE(output.visibility.size() == surfels.count());
  REQUIRE(output.in_view.size() == surfels.count());
  double sum = 0;
  for (std::size_t i = 0; i < surfels.count(); ++i) {
    INFO("surfel " << i);
    const auto visibility = static_cast<double>(output.visibility[i]);
    // One flipped cut-off of a pixel moves a weight by at most 1/255.
    CHECK(visibility == Approx(reference.visibility[i]).epsilon(1e-3).margin(1.0 / 255));
    if (visibility > 0) CHECK(output.in_view[i] == 1);
    sum += visibility;
  }
  const std::span<const float> alpha = output.alpha.values();
  CHECK(sum == Approx(std::accumulate(alpha.begin(), alpha.end(), 0.0)));
}

TEST_CASE("A hundred thousand surfels equal the reference at a sample of pixels") {
  Rng rng(8);
  const Camera camera = random_camera(rng, {240, 135});
  RandomSurfels options = all_kinds();
  options.count = 100'000;
  options.at_camera = options.huge = 0.001;
  options.max_sigma_px = 4;
  options.max_opacity = 0.3;
  const SurfelArrays surfels = random_surfels(options, camera, rng);
  const ReferenceRenderer reference(reference_input(surfels.view()), camera, kAllMaps);
  const RenderErrors errors =
      compare_render(rasterize(surfels, camera), reference, {240, 135}, 211);
  CHECK(errors.clean + errors.near_cutoff == 154);
  // With hundreds of surfels over a pixel most pixels are near some cut-off; one that tips over
  // moves the pixel by that surfel's weight, near 1/255 times the transmittance.
  CHECK(errors.largest() < kGrazingTolerance);
  CHECK(errors.flipped < 16);
}

TEST_CASE("Without surfels the maps are zero and have the image's size") {
  const RasterOutput output = rasterize(SurfelArrays{}, small_camera());
  for (const Image* map :
       {&output.features,
        &output.alpha,
        &output.depth_sum,
        &output.depth_median,
        &output.normal,
        &output.distortion,
        &output.plane_distance}) {
    CHECK(map->size() == ImageSize{21, 21});
    CHECK(
        std::count(map->values().begin(), map->values().end(), 0.0f) ==
        static_cast<std::ptrdiff_t>(map->values().size())
    );
  }
  CHECK(output.visibility.empty());
  CHECK(output.in_view.empty());
}

TEST_CASE("Maps and statistics beyond the usual are made only when asked for, and change no other"
) {
  const int channels = GENERATE(3, 5, 7);
  const int lanes = GENERATE(16, 8, 1);
  Rng rng(13);
  const Camera camera = random_camera(rng, {33, 17});
  const SurfelArrays surfels =
      random_surfels({.channels = channels, .edge_on = 0.1, .tiny = 0.2}, camera, rng);
  const Image one(33, 17, 1, 1.0f), three(33, 17, 3, 1.0f);
  const RasterOutputGradient ones{Image(33, 17, channels, 1.0f), one, one, one, three, {}, {}};
  const auto run = [&](const RasterSettings& settings) {
    Rasterizer rasterizer;
    ForwardBackward result;
    result.output = rasterizer.forward({surfels.view(), camera, with_lanes(settings, lanes)});
    result.gradient = rasterizer.backward(ones);
    return result;
  };
  ForwardBackward without = run({}), with = run(kAllMaps);
  CHECK(without.output.distortion.empty());
  CHECK(without.output.plane_distance.empty());
  CHECK(without.output.owned_pixels.empty());
  CHECK(without.output.radii.empty());
  CHECK(without.gradient.screen_abs.empty());
  CHECK_FALSE(with.output.distortion.empty());
  CHECK_FALSE(with.output.plane_distance.empty());
  CHECK(with.output.owned_pixels.size() == surfels.count());
  CHECK(with.output.radii.size() == surfels.count());
  CHECK(with.gradient.screen_abs.size() == 2 * surfels.count());
  with.output.distortion = with.output.plane_distance = {};
  with.output.owned_pixels = with.output.radii = with.gradient.screen_abs = {};
  check_same_bytes(with.output, without.output);
  check_same_bytes(with.gradient, without.gradient);
}

TEST_CASE("A surfel owns the pixels where it counts and more than half of the light is left") {
  Rng rng(14);
  const Camera camera = random_camera(rng, {33, 17});
  const SurfelArrays surfels = random_surfels({.min_opacity = 0.1, .edge_on = 0.2}, camera, rng);
  const RasterOutput output = rasterize(surfels, camera);
  const ReferenceOutput reference =
      reference_render(reference_input(surfels.view()), camera, kAllMaps);
  std::ptrdiff_t unsure = 0;  // pixels where rounding may decide
  for (const ReferencePixel& pixel : reference.pixels)
    unsure += pixel.cutoffs.nearest_jump_or_median() <= kCutoffGuard ? 1 : 0;
  REQUIRE(unsure < 200);  // of 561
  double differences = 0, sum = 0;
  for (std::size_t i = 0; i < surfels.count(); ++i) {
    const auto owned = static_cast<double>(output.owned_pixels[i]);
    differences += std::abs(owned - reference.owned_pixels[i]);
    sum += owned;
  }
  // Of the pixels near a cut-off few fall on its other side; one that does moves a count or two.
  CHECK(differences <= 2 + 0.02 * static_cast<double>(unsure));
  CHECK(sum > 561);
}

TEST_CASE("What is hidden behind a wall owns no pixel") {
  SurfelArrays surfels;
  add_facing(surfels, {0, 0, 2}, 5, 0.9, 1);
  add_facing(surfels, {0, 0, 3}, 0.5, 0.9, 1);
  add_facing(surfels, {0, 0, 1.5}, 0.1, 0.4, 1);
  const RasterOutput output = rasterize(surfels, small_camera());
  CHECK(output.owned_pixels[0] == 441);  // 0.6 is left behind what stands in front
  CHECK(output.owned_pixels[1] == 0);
  CHECK(output.owned_pixels[2] > 0);
}

TEST_CASE("The radius is half the larger side of the three-sigma box on the screen") {
  Rng rng(15);
  const Camera camera = random_camera(rng, {33, 17});
  const SurfelArrays surfels = random_surfels(all_kinds(), camera, rng);
  const ReferenceInput input = reference_input(surfels.view());
  const RasterOutput output = rasterize(surfels, camera);
  int boxes = 0;
  for (std::size_t i = 0; i < surfels.count(); ++i) {
    const ReferenceSurfel s = reference_surfel(input, i, camera);
    const auto radius = static_cast<double>(output.radii[i]);
    INFO("surfel " << i);
    if (output.in_view[i] == 0) {
      CHECK(radius == 0);
    } else if (s.has_low_pass && s.center_depth > 0) {
      const double half = std::max(s.box_half_extent.x, s.box_half_extent.y);
      CHECK(radius == Approx(half).epsilon(1e-3 / std::min(1.0, s.camera_plane_margin)));
      ++boxes;
    } else {
      CHECK(radius > 0);
    }
  }
  CHECK(boxes > 30);
  SurfelArrays facing;
  add_facing(facing, {0, 0, 2}, 0.4, 0.02, 1);  // sigma 4 pixels; faint: seen to 1.8 sigma
  CHECK(rasterize(facing, small_camera()).radii[0] == Approx(12));
}

TEST_CASE("The distortion of thin layers and its gradients keep their digits") {
  const double gap = GENERATE(1.0, 0.1, 0.01);  // metres
  INFO("layers " << gap << " m apart");
  SurfelArrays surfels;
  add_facing(surfels, {0, 0, 4}, 4, 0.5, 1);
  add_facing(surfels, {0, 0, 4 + gap}, 4, 0.5, 1);
  const Camera camera = small_camera();
  Rasterizer rasterizer;
  RasterOutputGradient dL_doutput;
  dL_doutput.distortion = Image(21, 21, 1);
  dL_doutput.distortion.at(10, 10) = 1;
  const RasterOutput output = rasterizer.forward({surfels.view(), camera, kAllMaps});
  const RasterGradient gradient = rasterizer.backward(dL_doutput);

  // Both are met in their middle: L = w1 w2 (m2 - m1)^2 with w1 = o1, w2 = o2 (1 - o1), and
  // dL/do1 = 0 at o1 = 1/2. A depth of 4 m is rounded by 2.4e-7 m: 1e-4 of L at a gap of 1 cm.
  const double scale = 100 * 0.2 / 99.8, far = 4 + gap;
  const double step = scale * (1 / 4.0 - 1 / far);
  const auto check = [](float actual, double expected) {
    CHECK(static_cast<double>(actual) == Approx(expected).epsilon(1e-3));
  };
  check(output.distortion.at(10, 10), 0.125 * step * step);
  check(gradient.opacities[1], 0.25 * step * step);
  CHECK(std::abs(static_cast<double>(gradient.opacities[0])) < 1e-3 * step * step);
  check(gradient.means[2], -0.25 * step * scale / 16);
  check(gradient.means[5], 0.25 * step * scale / (far * far));
}

TEST_CASE("One facing surfel leaves a Gaussian profile") {
  SurfelArrays surfels;
  add_facing(surfels, {0, 0, 2}, 0.4, 0.8, 3);  // sigma 4 pixels
  const RasterOutput output = rasterize(surfels, small_camera());
  for (int x = 0; x < 21; ++x) {
    const double sigmas = (x - 10) / 4.0, alpha = 0.8 * std::exp(-0.5 * sigmas * sigmas);
    CHECK(static_cast<double>(output.alpha.at(x, 10)) == Approx(alpha).epsilon(1e-5));
    CHECK(static_cast<double>(output.features.at(x, 10)) == Approx(3 * alpha).epsilon(1e-5));
    CHECK(static_cast<double>(output.depth_median.at(x, 10)) == Approx(2));
  }
  CHECK(output.alpha.at(0, 0) == 0.0f);  // 3.5 sigma
}

TEST_CASE("The order is that of centre depths, and of indices where depths are equal") {
  SurfelArrays surfels;
  add_facing(surfels, {0.1, 0, 3}, 1, 0.5, 1);
  add_facing(surfels, {0, 0.1, 2}, 1, 0.5, 10);
  add_facing(surfels, {0, 0, 3}, 1, 0.5, 100);
  const RasterOutput output = rasterize(surfels, small_camera());
  const ReferenceRenderer reference(reference_input(surfels.view()), small_camera(), kAllMaps);
  check_errors(compare_render(output, reference, {21, 21}), kTolerance);
  CHECK(output.features.at(10, 10) == Approx(5 + 0.25 * 0.995 + 12.5).epsilon(0.01));
}

TEST_CASE("Surfels whose centres lie behind the camera are ordered by their signed depth") {
  // Two floors that fall by 0.1 a metre, y = 0.5 + 0.1 (z - z_c); their centres are at z_c = -1,
  // -2.
  const double half = std::atan(10) / 2;
  const Vec4<double> q{std::cos(half), std::sin(half), 0, 0};
  SurfelArrays surfels;
  surfels.channels = 1;
  surfels.add({0, 0.5, -1}, {3, 3}, q, 0.5, {1});
  surfels.add({0, 0.5, -2}, {3, 3}, q, 0.5, {10});
  const RasterOutput output = rasterize(surfels, small_camera());
  const ReferenceRenderer reference(reference_input(surfels.view()), small_camera(), kAllMaps);
  const ReferencePixel pixel = reference.pixel(10, 20);
  REQUIRE(pixel.weights.size() == 2);
  CHECK(pixel.weights[0].first == 1);
  check_errors(compare_render(output, reference, {21, 21}), kTolerance);
}

TEST_CASE("What lies wholly before the near plane or beside the image is out of view") {
  SurfelArrays surfels;
  add_facing(surfels, {0, 0, 0.19}, 1, 0.9, 1);
  add_facing(surfels, {0, 0, -3}, 1, 0.9, 1);
  add_facing(surfels, {30, 0, 2}, 1, 0.9, 1);
  add_facing(surfels, {0, -30, 2}, 1, 0.9, 1);
  add_facing(surfels, {0, 0, 2}, 1, 0.9, 1);
  const RasterOutput output = rasterize(surfels, small_camera());
  CHECK(output.in_view == Array<std::uint8_t>{0, 0, 0, 0, 1});
  for (std::size_t i = 0; i < 4; ++i) CHECK(output.visibility[i] == 0);
  CHECK(output.visibility[4] > 0);
}

TEST_CASE("A floor whose centre lies before the near plane shows its part in front") {
  // The plane y = 1 around the camera: the ray through y has slope v = (y - cy) / f, depth 1 / v.
  SurfelArrays surfels;
  surfels.channels = 1;
  const double half = std::numbers::pi / 4;
  surfels.add({0, 1, 0}, {2, 2}, {std::cos(half), std::sin(half), 0, 0}, 0.9, {1});
  const RasterOutput output = rasterize(surfels, small_camera());
  for (int y = 11; y < 21; ++y) {
    const double z = 20.0 / (y - 10), rho = z * z / 4;
    const double alpha = rho <= 9 ? 0.9 * std::exp(-rho / 2) : 0;
    INFO("row " << y);
    CHECK(static_cast<double>(output.alpha.at(10, y)) == Approx(alpha).epsilon(1e-5));
    CHECK(
        static_cast<double>(output.depth_median.at(10, y)) ==
        Approx(alpha > 1.0 / 255 ? z : 0.0).epsilon(1e-5)
    );
  }
  CHECK(output.alpha.at(10, 5) == 0);
}

TEST_CASE("The low-pass shows a surfel far smaller than a pixel, at its centre's depth") {
  SurfelArrays surfels;
  add_facing(surfels, {0, 0, 2}, 1e-6, 0.8, 1);
  const RasterOutput output = rasterize(surfels, small_camera());
  const auto alpha = [&](int x) { return static_cast<double>(output.alpha.at(x, 10)); };
  CHECK(alpha(10) == Approx(0.8).epsilon(1e-5));
  CHECK(alpha(11) == Approx(0.8 * std::exp(-1.0)).epsilon(1e-5));
  CHECK(alpha(12) == Approx(0.8 * std::exp(-4.0)).epsilon(1e-5));
  CHECK(alpha(13) == 0);  // rho2 = 18
  CHECK(output.depth_median.at(11, 10) == 2.0f);
}

TEST_CASE("A surfel seen exactly edge on leaves finite values around its centre's depth") {
  SurfelArrays surfels;
  surfels.channels = 1;
  const double half = std::numbers::pi / 4;  // the normal along x, its plane through the camera
  surfels.add({0, 0, 2}, {0.3, 0.3}, {std::cos(half), 0, std::sin(half), 0}, 0.8, {1});
  Rasterizer rasterizer;
  const auto [output, gradient] = forward_backward(rasterizer, surfels, small_camera());
  for (const Image* map : {&output.features, &output.alpha, &output.depth_sum, &output.normal})
    for (const float value : map->values()) CHECK(std::isfinite(value));
  for (const auto* values :
       {&gradient.means, &gradient.scales, &gradient.rotations, &gradient.opacities})
    for (const float value : *values) CHECK(std::isfinite(value));
  CHECK(output.alpha.at(11, 10) == Approx(0.8 * std::exp(-1.0)).epsilon(0.05));
}

TEST_CASE("Transmittance stays at or above its limit however many opaque surfels are stacked") {
  SurfelArrays surfels;
  for (int i = 0; i < 50; ++i) add_facing(surfels, {0, 0, 1 + 0.1 * i}, 5, 0.9, 1);
  const RasterOutput output = rasterize(surfels, small_camera());
  for (const float alpha : output.alpha.values()) {
    CHECK(alpha <= 1 - 0.99e-4f);
    CHECK(alpha > 0.99f);
  }
}

TEST_CASE("The length of a quaternion does not matter") {
  Rng rng(9);
  const Camera camera = random_camera(rng, {33, 17});
  SurfelArrays surfels = random_surfels({}, camera, rng);
  const RasterOutput before = rasterize(surfels, camera);
  for (float& value : surfels.rotations) value *= 4;  // exact in binary
  const RasterOutput after = rasterize(surfels, camera);
  CHECK(same_bytes(before.features.values(), after.features.values()));
}

TEST_CASE("Bytes do not depend on the number of threads or on repetition") {
  Rng rng(11);
  const Camera camera = random_camera(rng, {240, 135});
  RandomSurfels options = all_kinds();
  options.count = 3000;
  const SurfelArrays surfels = random_surfels(options, camera, rng);
  Rasterizer rasterizer;
  const auto run = [&] { return forward_backward(rasterizer, surfels, camera); };
  const ForwardBackward one = with_threads(1, run);
  for (const int threads : {2, 2, 5, 1}) {
    const ForwardBackward other = with_threads(threads, run);
    check_same_bytes(one.output, other.output);
    check_same_bytes(one.gradient, other.gradient);
  }
}

TEST_CASE("A rasteriser used before for other sizes gives what a fresh one gives") {
  Rasterizer used;
  for (const auto& [width, height, count] :
       {std::array{240, 135, 500},
        std::array{7, 5, 20},
        std::array{33, 17, 0},
        std::array{64, 48, 90}}) {
    Rng rng(12);
    const Camera camera = random_camera(rng, {width, height});
    RandomSurfels options = all_kinds();
    options.count = static_cast<std::size_t>(count);
    const SurfelArrays surfels = random_surfels(options, camera, rng);
    const ForwardBackward again = forward_backward(used, surfels, camera);
    Rasterizer fresh;
    const ForwardBackward first = forward_backward(fresh, surfels, camera);
    check_same_bytes(first.output, again.output);
    check_same_bytes(first.gradient, again.gradient);
    CHECK(used.num_pairs() == fresh.num_pairs());
  }
}
