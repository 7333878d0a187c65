// SPDX-License-Identifier: MIT
// The float backward pass: against central differences of the double reference renderer for every
// parameter and every output map, and against closed forms.
//
// Tolerance 1e-3 of the gradient's norm. A pixel's rho carries a relative rounding error near 1e-5
// (image coordinates over splat widths, see compare_render.h); derivatives divide by another splat
// width and add terms of both signs, which costs one to two digits.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "glint/render/rasterize.h"
#include "glint/render/splat_hit.h"
#include "tests/support/facing_layers.h"
#include "tests/support/golden_surfel.h"
#include "tests/support/gradcheck.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr double kTolerance = 1e-3;
// Pixels this near (relative) to a cut-off get no weight: no step of the differences may cross it.
constexpr double kStepGuard = 1e-2;

constexpr const char* kAll = "all maps";

struct Case {
  SurfelArrays surfels;
  Camera camera;
  RasterSettings settings;
  RasterOutputGradient dL_doutput;
  Image near_limit;  // empty: none

  RasterInput input() const {
    RasterInput result = surfels.view();
    if (!near_limit.empty()) result.near_limit = near_limit;
    return result;
  }
  ReferenceInput reference() const { return reference_input(input()); }
};

// Random weights for one map; zero where `clean` is.
Image random_weights(Rng& rng, const std::vector<bool>& clean, ImageSize size, int channels) {
  Image weights(size.width, size.height, channels);
  for (std::size_t i = 0; i < weights.values().size(); ++i) {
    const float weight = rng.uniform(-1, 1);
    weights.values()[i] = clean[i / static_cast<std::size_t>(channels)] ? weight : 0.0f;
  }
  return weights;
}

std::vector<bool> pixels_away_from_cutoffs(const Case& c) {
  const ReferenceOutput output = reference_render(c.reference(), c.camera, c.settings);
  std::vector<bool> clean;
  for (const ReferencePixel& pixel : output.pixels)
    clean.push_back(pixel.cutoffs.nearest_of_all() > kStepGuard);
  return clean;
}

void weigh_outputs(Case& c, const std::string& map, Rng& rng) {
  const std::vector<bool> clean = pixels_away_from_cutoffs(c);
  const auto share = static_cast<double>(std::count(clean.begin(), clean.end(), true)) /
                     static_cast<double>(clean.size());
  REQUIRE(share > 0.3);  // else the comparison says little
  for_each_map(
      RasterCall{c.input(), c.camera, c.settings}.maps(),
      [&](const char* name, int channels, Image& weights) {
        const bool wanted = channels > 0 && (map == name || map == kAll);
        weights = wanted ? random_weights(rng, clean, c.camera.size(), channels) : Image{};
      },
      c.dL_doutput
  );
}

Case random_case(const RandomSurfels& options, const std::string& map, std::uint64_t seed) {
  Rng rng(seed);
  Case c;
  c.camera = random_camera(rng, {24, 18});
  c.settings.with_distortion = map == "distortion" || map == kAll;
  c.settings.with_plane_distance = map == "plane_distance" || map == kAll;
  c.surfels = random_surfels(options, c.camera, rng);
  weigh_outputs(c, map, rng);
  return c;
}

RandomSurfels smooth_surfels() {
  RandomSurfels options;
  options.count = 6;
  options.channels = 4;
  options.min_sigma_px = 2;
  options.max_sigma_px = 8;
  options.min_depth = 1;
  options.max_depth = 4;
  options.min_opacity = 0.2;
  options.max_opacity = 0.7;
  return options;
}

RasterGradient backward(const Case& c) {
  Rasterizer rasterizer;
  rasterizer.forward({c.input(), c.camera, c.settings});
  return rasterizer.backward(c.dL_doutput);
}

// An input array, its float gradient, and the step for its differences.
struct Parameter {
  const char* name;
  std::vector<double> ReferenceInput::*values;
  FloatArray RasterGradient::*gradient;
  DifferenceStep step;
};
constexpr DifferenceStep kAbsolute{2e-5, 1}, kRelative{1e-4, 0};
constexpr Parameter kParameters[] = {
    {"means", &ReferenceInput::means, &RasterGradient::means, kAbsolute},
    {"scales", &ReferenceInput::scales, &RasterGradient::scales, kRelative},
    {"rotations", &ReferenceInput::rotations, &RasterGradient::rotations, kAbsolute},
    {"opacities", &ReferenceInput::opacities, &RasterGradient::opacities, kAbsolute},
    {"features", &ReferenceInput::features, &RasterGradient::features, kAbsolute}};

std::vector<double> numeric_gradient(const Case& c, const Parameter& parameter) {
  ReferenceInput input = c.reference();
  const auto loss = [&](const std::vector<double>& values) {
    input.*parameter.values = values;
    return reference_loss(reference_render(input, c.camera, c.settings), c.dL_doutput);
  };
  return central_differences(loss, input.*parameter.values, parameter.step);
}

double norm(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum);
}

// The error of each array relative to its gradient's norm; where that (nearly) vanishes, as the
// depth's with respect to scales, to a hundredth of the largest norm: terms of that size cancel.
void check_gradients(const Case& c) {
  const RasterGradient actual = backward(c);
  std::vector<std::vector<double>> expected;
  double largest = 0;
  for (const Parameter& parameter : kParameters) {
    expected.push_back(numeric_gradient(c, parameter));
    largest = std::max(largest, norm(expected.back()));
  }
  REQUIRE(largest > 1e-6);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const FloatArray& gradient = actual.*kParameters[i].gradient;
    REQUIRE(gradient.size() == expected[i].size());
    const GradientError error = gradient_error<float>(gradient, expected[i]);
    INFO(kParameters[i].name << ": norm " << error.norm << ", worst at " << error.worst_index);
    CHECK(error.distance / std::max(error.norm, 0.01 * largest) < kTolerance);
  }
}

}  // namespace

TEST_CASE("Each output map's gradient matches central differences") {
  std::vector<std::string> maps;
  RasterOutput output;
  for_each_map(
      {3, true, true}, [&](const char* name, int, Image&) { maps.push_back(name); }, output
  );
  const std::string map = GENERATE_COPY(from_range(maps));
  const std::uint64_t seed = GENERATE(1, 2, 3);
  INFO(map << ", seed " << seed);
  check_gradients(random_case(smooth_surfels(), map, seed));
}

TEST_CASE("The gradients of all maps together match central differences") {
  const std::uint64_t seed = GENERATE(range(10, 20));
  INFO("seed " << seed);
  check_gradients(random_case(smooth_surfels(), kAll, seed));
}

TEST_CASE("Gradients match where the low-pass alone decides, edge-on, and across the camera plane"
) {
  struct Kind {
    const char* name;
    double RandomSurfels::*share;
    std::size_t count;
    std::uint64_t first_seed;
  };
  const Kind kind = GENERATE(
      Kind{"tiny", &RandomSurfels::tiny, 12, 30},
      Kind{"edge on", &RandomSurfels::edge_on, 8, 40},
      Kind{"at the camera", &RandomSurfels::at_camera, 6, 50}
  );
  const std::uint64_t seed = kind.first_seed + GENERATE(0, 1, 2, 3, 4);
  INFO(kind.name << ", seed " << seed);
  RandomSurfels options = smooth_surfels();
  options.*kind.share = 1;
  options.count = kind.count;
  check_gradients(random_case(options, kAll, seed));
}

TEST_CASE("Gradients match behind a near limit that differs from pixel to pixel") {
  Rng rng(60);
  Case c;
  c.camera = random_camera(rng, {24, 18});
  c.settings.with_distortion = c.settings.with_plane_distance = true;
  c.surfels = random_surfels(smooth_surfels(), c.camera, rng);
  c.near_limit = Image(24, 18, 1);
  for (float& limit : c.near_limit.values()) limit = rng.uniform(0, 3);
  weigh_outputs(c, kAll, rng);
  check_gradients(c);
}

TEST_CASE("The backward pass reproduces the golden derivatives of rho and depth") {
  Case c{golden_surfel(), golden_camera(), {}, {}, {}};
  const double alpha = 0.7626927772;
  const auto at_pixel = [](double value) {
    Image weights(640, 480, 1);
    weights.at(352, 230) = static_cast<float>(value);
    return weights;
  };
  GoldenGradient golden = kGoldenRho3;
  SECTION("rho3, since d alpha = -alpha / 2 d rho") { c.dL_doutput.alpha = at_pixel(-2 / alpha); }
  SECTION("depth by the median") {
    golden = kGoldenDepth;
    c.dL_doutput.depth_median = at_pixel(1);
  }
  SECTION("depth by the sum, less the part of alpha") {
    golden = kGoldenDepth;
    c.dL_doutput.depth_sum = at_pixel(1 / alpha);
    c.dL_doutput.alpha = at_pixel(-4.0581995682 / alpha);
  }
  const RasterGradient gradient = backward(c);
  const auto check = [](const FloatArray& actual, const auto& expected) {
    // Float rounding of terms that cancel: a few 1e-6 of the largest derivative, which is 2.4.
    for (std::size_t i = 0; i < expected.size(); ++i)
      CHECK(static_cast<double>(actual[i]) == Approx(expected[i]).epsilon(1e-5).margin(1e-5));
  };
  check(gradient.means, golden.mean);
  check(gradient.rotations, golden.rotation);
  check(gradient.scales, golden.scale);
}

TEST_CASE("A clamped alpha passes no gradient to opacity and shape, but to features and depth") {
  Case c;
  c.camera = random_case(smooth_surfels(), "alpha", 1).camera;
  const Vec3d mean = 2.0 * c.camera.ray_in_cam(12.5, 9.5);
  c.surfels.add(c.camera.to_world(mean), {0.5, 0.5}, {1, 0.1, 0.2, 0}, 1, {1, 1, 1});
  Image weights(24, 18, 1);
  weights.at(12, 9) = 1;
  const auto total = [](const FloatArray& values) {
    float sum = 0;
    for (const float value : values) sum += std::abs(value);
    return sum;
  };
  c.dL_doutput.alpha = weights;
  const RasterGradient of_alpha = backward(c);
  CHECK(total(of_alpha.opacities) == 0);
  CHECK(total(of_alpha.means) == 0);
  CHECK(total(of_alpha.scales) == 0);
  CHECK(total(of_alpha.rotations) == 0);

  c.dL_doutput = {};
  c.dL_doutput.depth_sum = weights;
  const RasterGradient of_depth = backward(c);
  CHECK(total(of_depth.opacities) == 0);
  CHECK(total(of_depth.means) > 0.9f);

  c.dL_doutput = {};
  c.dL_doutput.features = Image(24, 18, 3, 1.0f);
  CHECK(total(backward(c).features) > 0.99f);
}

TEST_CASE("The screen gradient with the low-pass is that of a shift of the projected centre, in NDC"
) {
  const std::uint64_t seed = GENERATE(range(70, 73));
  const double tiny = GENERATE(0.0, 1.0);
  RandomSurfels options = smooth_surfels();
  options.tiny = tiny;
  Case c = random_case(options, kAll, seed);
  c.settings.screen_with_low_pass = true;
  c.dL_doutput.plane_distance = {};  // what it says of the centre is no shift on the screen
  const RasterGradient gradient = backward(c);
  REQUIRE(gradient.screen.size() == 2 * c.surfels.count());
  for (std::size_t i = 0; i < c.surfels.count(); ++i) {
    const auto vector = [i](const auto& values) {
      return cast<double>(Vec3f{values[3 * i], values[3 * i + 1], values[3 * i + 2]});
    };
    // A pixel's shift at fixed depth z moves the centre by z / f metres in the camera plane.
    const double z = c.camera.to_cam(vector(c.surfels.means)).z;
    const Vec3d in_cam = c.camera.rotation_cam_from_world * vector(gradient.means);
    const double x = in_cam.x * z / c.camera.fx * 0.5 * c.camera.width;
    const double y = in_cam.y * z / c.camera.fy * 0.5 * c.camera.height;
    const double margin = kTolerance * std::hypot(x, y);
    CHECK(static_cast<double>(gradient.screen[2 * i]) == Approx(x).margin(margin));
    CHECK(static_cast<double>(gradient.screen[2 * i + 1]) == Approx(y).margin(margin));
  }
}

TEST_CASE("Surfels within a pixel have no screen gradient but that of the low-pass") {
  Case c = random_case({.tiny = 1}, kAll, 75);
  for (float& scale : c.surfels.scales) scale *= 0.01f;
  const auto sum = [&](bool low_pass) {
    c.settings.screen_with_low_pass = low_pass;
    double total = 0;
    for (const float g : backward(c).screen) total += std::abs(static_cast<double>(g));
    return total;
  };
  const double with = sum(true);
  REQUIRE(with > 1e-3);
  CHECK(sum(false) < 1e-3 * with);
}

TEST_CASE("The absolute screen gradient sums what each pixel says of a shift of the footprint") {
  const std::uint64_t seed = GENERATE(range(80, 84));
  const std::string kind = GENERATE("smooth", "tiny", "edge on");
  INFO(kind << ", seed " << seed);
  RandomSurfels options = smooth_surfels();
  options.tiny = kind == "tiny" ? 1 : 0;
  options.edge_on = kind == "edge on" ? 1 : 0;
  Case c = random_case(options, kAll, seed);
  c.settings.with_statistics = true;
  const RasterGradient gradient = backward(c);
  REQUIRE(gradient.screen_abs.size() == 2 * c.surfels.count());

  const ReferenceRenderer reference(c.reference(), c.camera, c.settings);
  std::vector<double> expected(2 * c.surfels.count()), shift(2);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t axis = i % 2;
    const double ndc = 0.5 * (axis == 0 ? c.camera.width : c.camera.height);
    for (std::size_t p = 0; p < c.camera.size().num_pixels(); ++p) {
      const int x = static_cast<int>(p) % 24, y = static_cast<int>(p) / 24;
      const auto loss = [&](const std::vector<double>& by) {
        return reference_loss(reference.pixel(x, y, {i / 2, {by[0], by[1]}}), p, c.dL_doutput);
      };
      expected[i] += ndc * std::abs(central_difference(loss, shift, axis, kAbsolute));
    }
  }
  const GradientError error = gradient_error<float>(gradient.screen_abs, expected);
  INFO("norm " << error.norm << ", worst at " << error.worst_index);
  REQUIRE(error.norm > 1e-3);
  CHECK(error.distance < kTolerance * error.norm);
}

TEST_CASE("The absolute screen gradient of a facing surfel does not cancel") {
  // dL/ds = sum alpha (p - c) / sigma^2 vanishes by symmetry; its absolute value does not.
  Case c;
  c.camera = small_camera();
  c.settings.with_statistics = true;
  c.surfels.add({0, 0, 2}, {0.3, 0.3}, {1, 0, 0, 0}, 0.8, {1, 1, 1});  // sigma 3 pixels
  c.dL_doutput.alpha = Image(21, 21, 1, 1.0f);
  double expected = 0;
  for (int y = -10; y <= 10; ++y)
    for (int x = -10; x <= 10; ++x) {
      const double rho = (x * x + y * y) / 9.0, alpha = 0.8 * std::exp(-rho / 2);
      if (rho <= 9 && alpha >= 1.0 / 255) expected += 10.5 * alpha * std::abs(x) / 9.0;
    }
  const RasterGradient gradient = backward(c);
  for (int axis = 0; axis < 2; ++axis) {
    CHECK(static_cast<double>(gradient.screen_abs[axis]) == Approx(expected).epsilon(1e-4));
    CHECK(std::abs(static_cast<double>(gradient.screen[axis])) < 1e-3 * expected);
  }
}

TEST_CASE("Without output gradients every gradient is zero and has its input's shape") {
  Case c = random_case(smooth_surfels(), kAll, 1);
  c.dL_doutput = {};
  const RasterGradient gradient = backward(c);
  CHECK(gradient.means == FloatArray(c.surfels.means.size(), 0.0f));
  CHECK(gradient.scales == FloatArray(c.surfels.scales.size(), 0.0f));
  CHECK(gradient.rotations == FloatArray(c.surfels.rotations.size(), 0.0f));
  CHECK(gradient.opacities == FloatArray(c.surfels.opacities.size(), 0.0f));
  CHECK(gradient.features == FloatArray(c.surfels.features.size(), 0.0f));
  CHECK(gradient.screen == FloatArray(2 * c.surfels.count(), 0.0f));
}

TEST_CASE("Without a surface, colours and the gradients of all arrays have the same bytes") {
  for (const int lanes : {1, 8, 16}) {
    CAPTURE(lanes);
    RandomSurfels options = smooth_surfels();
    options.count = 200;
    options.channels = kColorChannels;
    options.edge_on = options.at_camera = options.tiny = 0.1;
    Rng rng(31);
    Case c;
    c.camera = random_camera(rng, {24, 18});
    c.surfels = random_surfels(options, c.camera, rng);
    c.settings.lanes = lanes;
    const ImageSize size = c.camera.size();
    c.dL_doutput.features =
        random_weights(rng, std::vector<bool>(size.num_pixels(), true), size, kColorChannels);
    Rasterizer with, without;
    const RasterOutput& whole = with.forward({c.input(), c.camera, c.settings});
    c.settings.with_surface = false;
    const RasterOutput& colors = without.forward({c.input(), c.camera, c.settings});
    CHECK(std::ranges::equal(colors.features.values(), whole.features.values()));
    CHECK(std::ranges::equal(colors.alpha.values(), whole.alpha.values()));
    CHECK(colors.visibility == whole.visibility);
    for (const Image* map : {&colors.depth_sum, &colors.depth_median, &colors.normal})
      CHECK(map->empty());
    const RasterGradient& g = without.backward(c.dL_doutput);
    RasterGradient::for_each_array(
        without.call().maps(),
        [](const char* name, std::size_t, const FloatArray& a, const FloatArray& b) {
          CAPTURE(name);
          CHECK(std::ranges::equal(a, b));
        },
        g,
        with.backward(c.dL_doutput)
    );
    CHECK_THROWS_WITH(
        [&] {
          Image depth;
          without.first_surface(colors.alpha, {}, depth);
        }(),
        Catch::Contains("without a surface")
    );
  }
}

struct PixelAt {
  int x, y;
};
// Pixels of the tiles that these lie in.
std::vector<bool> pixels_of_tiles(ImageSize size, std::initializer_list<PixelAt> within) {
  std::vector<bool> pixels(size.num_pixels());
  for (const PixelAt& p : within)
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        if (x / kTileSize == p.x / kTileSize && y / kTileSize == p.y / kTileSize)
          pixels[static_cast<std::size_t>(y) * size.width + x] = true;
  return pixels;
}

TEST_CASE("Tiles in which no hit can count have the same bytes as if they were gone through") {
  const ImageSize size{28, 18};
  for (const int lanes : {1, 8, 16}) {
    CAPTURE(lanes);
    RandomSurfels options = smooth_surfels();
    options.count = 200;
    options.channels = 4;
    Rng rng(38);
    Case c;
    c.camera = random_camera(rng, size);
    c.surfels = random_surfels(options, c.camera, rng);
    c.settings.lanes = lanes;
    const std::vector<bool> all(size.num_pixels(), true);
    c.dL_doutput.features = random_weights(rng, all, size, options.channels);
    Rasterizer skips, goes_through;
    Image far(size.width, size.height, 1);
    const auto forward = [&](Rasterizer& rasterizer, float elsewhere, Image& limit) {
      limit = Image(size.width, size.height, 1);
      std::ranges::fill(limit.values(), elsewhere);
      limit.at(7, 7) = limit.at(8, 17) = limit.at(27, 8) = 0;
      RasterInput input = c.input();
      input.near_limit = limit;
      return &rasterizer.forward({input, c.camera, c.settings});
    };
    const RasterOutput& a = *forward(skips, 1e30f, c.near_limit);
    const RasterOutput& b = *forward(goes_through, 1e20f, far);
    for_each_map(
        skips.call().maps(),
        [](const char* name, int, const Image& x, const Image& y) {
          CAPTURE(name);
          CHECK(std::ranges::equal(x.values(), y.values()));
        },
        a,
        b
    );
    const RasterGradient& gradient = skips.backward(c.dL_doutput);
    CHECK(std::ranges::any_of(gradient.features, [](float g) { return g != 0; }));
    const RasterGradient& other = goes_through.backward(c.dL_doutput);
    CHECK(gradient.features == other.features);
    CHECK(gradient.means == other.means);
  }
}

TEST_CASE("Tiles that nobody needs are empty, all others and their gradients have the same bytes") {
  const ImageSize size{28, 18};
  Image needed(size.width, size.height, 1);
  needed.at(7, 7) = needed.at(8, 17) = needed.at(27, 8) = 1;
  const std::vector<bool> made = pixels_of_tiles(size, {{7, 7}, {8, 17}, {27, 8}});
  for (const int lanes : {1, 8, 16}) {
    CAPTURE(lanes);
    RandomSurfels options = smooth_surfels();
    options.count = 200;
    options.channels = 4;
    Rng rng(37);
    Case c;
    c.camera = random_camera(rng, size);
    c.surfels = random_surfels(options, c.camera, rng);
    c.settings.lanes = lanes;
    c.dL_doutput.features = random_weights(rng, made, size, options.channels);
    Rasterizer all, some;
    const RasterOutput& whole = all.forward({c.input(), c.camera, c.settings});
    RasterInput input = c.input();
    input.needed = needed;
    const RasterOutput& parts = some.forward({input, c.camera, c.settings});
    for_each_map(
        all.call().maps(),
        [&](const char* name, int channels, const Image& a, const Image& b) {
          CAPTURE(name);
          for (std::size_t i = 0; i < a.values().size(); ++i)
            CHECK(a.data()[i] == (made[i / channels] ? b.data()[i] : 0.0f));
        },
        parts,
        whole
    );
    const FloatArray& gradient = some.backward(c.dL_doutput).features;
    CHECK(std::ranges::any_of(gradient, [](float g) { return g != 0; }));
    CHECK(gradient == all.backward(c.dL_doutput).features);
    input.needed = c.dL_doutput.features;
    CHECK_THROWS_WITH(
        some.forward({input, c.camera, c.settings}),
        Catch::Contains("needed is 28x18x4, expected the camera's 28x18x1")
    );
  }
}

TEST_CASE("A surfel that reaches no tile has exactly zero gradient, even when it is not finite") {
  Case c = random_case(smooth_surfels(), kAll, 3);
  c.surfels.means[0] = std::numeric_limits<float>::quiet_NaN();
  Rasterizer rasterizer;
  const RasterOutput output = rasterizer.forward({c.input(), c.camera, c.settings});
  const RasterGradient gradient = rasterizer.backward(c.dL_doutput);
  REQUIRE(output.in_view[0] == 0);
  for (int k = 0; k < 3; ++k) CHECK(gradient.means[k] == 0.0f);
  for (int k = 0; k < 4; ++k) CHECK(gradient.rotations[k] == 0.0f);
  for (const float value : gradient.screen) CHECK(std::isfinite(value));
}

TEST_CASE("A detached feature has its gradient, and where surfels are and how opaque has none of it"
) {
  Rng rng(23);
  const Camera camera = random_camera(rng, {48, 32});
  RandomSurfels options;
  options.count = 120;
  options.channels = 5;
  const SurfelArrays surfels = random_surfels(options, camera, rng);
  RasterOutputGradient with, without;
  with.features = without.features = Image(48, 32, 5);
  for (std::size_t i = 0; i < with.features.values().size(); ++i) {
    with.features.data()[i] = rng.uniform(-1, 1);
    without.features.data()[i] = i % 5 == 3 ? 0.0f : with.features.data()[i];
  }
  const auto gradient = [&](const RasterOutputGradient& dL, bool detached) {
    RasterSettings settings;
    if (detached) settings.detached_features = 1u << 3;
    Rasterizer rasterizer;
    rasterizer.forward({surfels.view(), camera, settings});
    return rasterizer.backward(dL);
  };
  const RasterGradient cut = gradient(with, true), none = gradient(without, false);
  const RasterGradient all = gradient(with, false);
  CHECK(cut.means == none.means);
  CHECK(cut.scales == none.scales);
  CHECK(cut.rotations == none.rotations);
  CHECK(cut.opacities == none.opacities);
  CHECK(cut.screen == none.screen);
  CHECK(cut.features == all.features);
  CHECK(cut.opacities != all.opacities);
}
