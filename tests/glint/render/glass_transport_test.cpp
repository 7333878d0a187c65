// SPDX-License-Identifier: MIT
// GlassTransport as a whole: central differences from the interface's maps to the picture, with a
// reflected radiance that is a known function of the mirrored rays.
#include "glint/render/glass_transport.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "glint/core/rng.h"
#include "tests/support/gradcheck.h"
#include "tests/support/random_scene.h"
#include "tests/support/random_values.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kWidth = 4, kHeight = 3;
constexpr std::size_t kInterfaceChannels = 5;  // colour, t, s

struct Fixture {
  Camera camera;
  RasterOutput interface;
  Image transmission, weights;
  GlassOptions options;

  explicit Fixture(std::uint64_t seed) {
    Rng rng(seed);
    camera = random_camera(rng, {kWidth, kHeight});
    options.channels = {.transparency = 3, .specular = 4};
    options.glass_f0 = 0.2f;
    interface.features =
        random_map(rng, camera.size(), static_cast<int>(kInterfaceChannels), 0.1f, 0.9f);
    for (std::size_t i = 0; i < interface.features.num_pixels(); ++i) {
      float& t = interface.features.data()[kInterfaceChannels * i + 3];
      if (std::abs(t - 0.5f) < 0.02f) t = 0.45f;  // what is glass does not depend on a step
    }
    interface.alpha = random_map(rng, camera.size(), 1, 0.5f, 1);
    interface.depth_sum = random_map(rng, camera.size(), 1, 1, 2);
    interface.normal = random_map(rng, camera.size(), 3, -0.3f, 0.3f);
    for (std::size_t i = 0; i < interface.normal.num_pixels(); ++i)
      interface.normal.data()[3 * i + 2] -= 0.7f;
    transmission = random_map(rng, camera.size(), 3, 0, 1);
    weights = random_map(rng, camera.size(), 3, -1, 1);
  }
  // Smooth in origin and direction.
  static Vec3f reflected(Vec3f o, Vec3f d) {
    return {std::sin(o.x + 2 * d.y), o.y * d.z, d.x * d.x + 0.3f * o.z};
  }
  GlassLayers layers(const GlassBuffer& buffer) const {
    GlassLayers layers{Image(kWidth, kHeight, 3), transmission, Image(kWidth, kHeight, 3)};
    for (std::size_t i = 0; i < transmission.num_pixels(); ++i) {
      const float *o = buffer.reflected.origins.data() + 3 * i,
                  *d = buffer.reflected.directions.data() + 3 * i;
      const Vec3f r = reflected({o[0], o[1], o[2]}, {d[0], d[1], d[2]});
      for (int c = 0; c < 3; ++c) {
        layers.interface.data()[3 * i + static_cast<std::size_t>(c)] =
            interface.features.data()[kInterfaceChannels * i + static_cast<std::size_t>(c)];
        layers.reflection.data()[3 * i + static_cast<std::size_t>(c)] = r[c];
      }
    }
    return layers;
  }
  double loss() const {
    GlassTransport transport(options);
    const GlassLayers l = layers(transport.read_interface(camera, interface));
    const Image& image = transport.compose(l);
    double sum = 0;
    for (std::size_t i = 0; i < image.values().size(); ++i)
      sum += static_cast<double>(weights.values()[i]) * static_cast<double>(image.values()[i]);
    return sum;
  }
  RasterOutputGradient gradient() const {
    GlassTransport transport(options);
    const GlassBuffer& buffer = transport.read_interface(camera, interface);
    const GlassLayers l = layers(buffer);
    transport.compose(l);
    const GlassLayers& g = transport.compose_vjp(l, weights);
    Rays dL_drays{Image(kWidth, kHeight, 3), Image(kWidth, kHeight, 3)};
    for (std::size_t i = 0; i < transmission.num_pixels(); ++i) {
      const float *o = buffer.reflected.origins.data() + 3 * i,
                  *d = buffer.reflected.directions.data() + 3 * i;
      const float* r = g.reflection.data() + 3 * i;
      float *go = dL_drays.origins.data() + 3 * i, *gd = dL_drays.directions.data() + 3 * i;
      go[0] = r[0] * std::cos(o[0] + 2 * d[1]);
      gd[1] = 2 * go[0];
      go[1] = r[1] * d[2];
      gd[2] = r[1] * o[1];
      gd[0] = r[2] * 2 * d[0];
      go[2] = 0.3f * r[2];
    }
    RasterOutputGradient result;
    result.features = Image(kWidth, kHeight, static_cast<int>(kInterfaceChannels));
    result.alpha = Image(kWidth, kHeight, 1);
    result.depth_sum = Image(kWidth, kHeight, 1);
    result.normal = Image(kWidth, kHeight, 3);
    transport.interface_vjp(camera, interface, &dL_drays, {}, result);
    return result;
  }
  // Float arithmetic: a step of 2e-3 leaves three digits.
  void check(Image RasterOutput::*field, const Image& actual, const char* name) {
    std::vector<double> expected;
    for (float& value : (interface.*field).values()) {
      const float at = value, h = 2e-3f;
      value = at + h;
      const double above = loss();
      value = at - h;
      const double below = loss();
      value = at;
      expected.push_back((above - below) / (2 * static_cast<double>(h)));
    }
    const GradientError error = gradient_error<float>(actual.values(), expected);
    INFO(name << ", worst at " << error.worst_index);
    CHECK(error.norm > 0);
    CHECK(error.distance < 5e-3 * error.norm);
  }
};

}  // namespace

TEST_CASE("gradients reach colour, t, s, depth, alpha and normal of the interface") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Fixture f(seed);
    const RasterOutputGradient g = f.gradient();
    f.check(&RasterOutput::features, g.features, "features");
    f.check(&RasterOutput::depth_sum, g.depth_sum, "depth_sum");
    f.check(&RasterOutput::alpha, g.alpha, "alpha");
    f.check(&RasterOutput::normal, g.normal, "normal");
  }
}

TEST_CASE("gradients reach them in linear light, too") {
  Fixture f(7);
  f.options.linear_light = true;
  const RasterOutputGradient g = f.gradient();
  f.check(&RasterOutput::features, g.features, "features");
  f.check(&RasterOutput::depth_sum, g.depth_sum, "depth_sum");
  f.check(&RasterOutput::normal, g.normal, "normal");
}

TEST_CASE("detached origins leave depth without gradient, and only that") {
  Fixture f(4);
  f.options.detach_origins = true;
  const RasterOutputGradient g = f.gradient();
  for (const float value : g.depth_sum.values()) CHECK(value == 0.0f);
  double norm = 0;
  for (const float value : g.normal.values()) norm += std::abs(static_cast<double>(value));
  CHECK(norm > 0);
}

TEST_CASE("a set that is switched off leaves neither darkness nor gradient") {
  Fixture f(5);
  f.options.transmission = false;
  f.options.reflection = false;
  GlassTransport transport(f.options);
  GlassLayers l = f.layers(transport.read_interface(f.camera, f.interface));
  l.transmission = {};
  l.reflection = {};
  const Image& image = transport.compose(l);
  for (std::size_t i = 0; i < image.values().size(); ++i)
    CHECK(image.values()[i] == l.interface.values()[i]);
  const GlassLayers& g = transport.compose_vjp(l, f.weights);
  for (std::size_t i = 0; i < image.values().size(); ++i)
    CHECK(g.interface.values()[i] == f.weights.values()[i]);
}

TEST_CASE("glass mirrors its own share of what meets it along the normal") {
  Fixture f(8);
  GlassTransport transport(f.options);
  const Image glass = transport.read_interface(f.camera, f.interface).fresnel;
  f.options.glass_f0 = f.options.f0;
  transport.set_options(f.options);
  const GlassBuffer& alike = transport.read_interface(f.camera, f.interface);
  for (std::size_t i = 0; i < glass.num_pixels(); ++i) {
    const float plain = alike.fresnel.data()[i], steep = (plain - 0.04f) / 0.96f;
    const bool is_pane = alike.transparency.data()[i] > 0.5f;
    CHECK(glass.data()[i] == Approx(is_pane ? 0.2f + 0.8f * steep : plain));
  }
}

TEST_CASE("pixels without a surface mirror nothing and show the interface as it is") {
  Fixture f(6);
  for (Image* image : {&f.interface.alpha, &f.interface.depth_sum, &f.interface.normal})
    std::fill(image->values().begin(), image->values().end(), 0.0f);
  std::fill(f.interface.features.values().begin(), f.interface.features.values().end(), 0.0f);
  GlassTransport transport(f.options);
  const GlassBuffer& buffer = transport.read_interface(f.camera, f.interface);
  for (const float value : buffer.specularity.values()) CHECK(value == 0.0f);
  for (const float value : buffer.reflected.directions.values()) CHECK(value == 0.0f);
}
