// SPDX-License-Identifier: MIT
// The networks of cuDNN against those of oneDNN, with plain loops in cuDNN's place (cudnn/).
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "glint/core/device.h"
#include "metrics/feature_net_backends.h"
#include "tests/metrics/golden_images.h"
#include "tests/metrics/tiny_lpips.h"

namespace glint::test {  // of cudnn/cudnn.cpp
extern bool cudnn_fails;
extern int cudnn_handles;
}  // namespace glint::test

using namespace glint;
using namespace glint::test;

namespace {

LpipsWeights random_weights(const LpipsNetwork& network) {
  return make_lpips_weights(network, random_arrays(network), network.name);
}

double largest_difference(ImageView a, ImageView b) {
  REQUIRE(a.size() == b.size());
  REQUIRE(a.channels == b.channels);
  double largest = 0, scale = 0;
  for (std::size_t i = 0; i < a.num_pixels() * static_cast<std::size_t>(a.channels); ++i) {
    largest = std::max(largest, static_cast<double>(std::abs(a.data[i] - b.data[i])));
    scale = std::max(scale, static_cast<double>(std::abs(b.data[i])));
  }
  REQUIRE(scale > 0);
  return largest / scale;
}

void feed(FeatureNet& net, float gain) {
  const Image image = golden::prediction_image(net.size().width, net.size().height, 3);
  std::transform(image.values().begin(), image.values().end(), net.input().data, [&](float v) {
    return gain * (2 * v - 1);
  });
  net.forward();
}

// A gradient at every tap that differs from value to value and adds to what is there.
ImageView backward(FeatureNet& net) {
  return net.backward([](std::size_t tap, ImageRef gradient) {
    const std::size_t count = gradient.width * static_cast<std::size_t>(gradient.height) *
                              static_cast<std::size_t>(gradient.channels);
    for (std::size_t i = 0; i < count; ++i)
      gradient.data[i] += std::sin(static_cast<float>(i + 7 * tap)) / static_cast<float>(count);
  });
}

void check_same_net(const LpipsNetwork& network, ImageSize size) {
  const std::vector<FeatureStep> steps = random_weights(network).steps;
  const auto cudnn = detail::make_cudnn_net(steps, size);
  const auto onednn = detail::make_onednn_net(steps, size);
  REQUIRE(cudnn != nullptr);
  REQUIRE(cudnn->num_taps() == onednn->num_taps());
  for (const float gain : {1.0f, 0.3f}) {  // the second picture meets the buffers of the first
    feed(*cudnn, gain);
    feed(*onednn, gain);
    for (std::size_t i = 0; i < cudnn->num_taps(); ++i) {
      INFO(network.name << ", " << size.width << " x " << size.height << ", tap " << i);
      CHECK(largest_difference(cudnn->tap(i), onednn->tap(i)) < 1e-5);
    }
    CHECK(largest_difference(backward(*cudnn), backward(*onednn)) < 1e-4);
  }
}

}  // namespace

TEST_CASE("Networks of cuDNN give the taps and gradients of oneDNN's, windows rounded both ways") {
  for (const ImageSize size : {ImageSize{31, 26}, {32, 27}, {33, 28}, {40, 33}})
    check_same_net(tiny_network(), size);
}

TEST_CASE("So do the published networks") {
  for (const LpipsNetwork& network : lpips_networks()) {
    if (network.name == "vgg") continue;  // seconds of plain loops, and no other kind of layer
    check_same_net(network, {70, 67});
  }
}

namespace {

void move_bytes(void* to, const void* from, std::size_t bytes) { std::memcpy(to, from, bytes); }

// A device's memory, on the host: blocks of their own, full of NaN.
const DeviceBackend memory_beside{
    .name = "memory beside the host's",
    .allocate =
        [](std::size_t bytes) {
          return std::memset(std::aligned_alloc(64, (bytes + 63) / 64 * 64), 0xff, bytes);
        },
    .release = [](void* block) noexcept { std::free(block); },
    .upload = move_bytes,
    .download = move_bytes,
    .copy = move_bytes,
    .clear = [](void* block, std::size_t bytes) { std::memset(block, 0, bytes); },
    .fill = [](float* to, std::size_t count, float value) { std::fill_n(to, count, value); },
    .synchronize = [] {},
    .room = [] { return std::size_t{1} << 30; }};

}  // namespace

TEST_CASE("A GPU in use runs networks by cuDNN; where cuDNN fails, the host runs them") {
  const std::vector<FeatureStep> steps = random_weights(tiny_network()).steps;
  const auto on_host = make_feature_net(steps, {31, 26});
  feed(*on_host, 1);
  const int before = cudnn_handles;
  use_gpu(memory_beside);
  for (const bool fails : {false, true}) {
    cudnn_fails = fails;
    const auto net = make_feature_net(steps, {31, 26});
    CHECK(cudnn_handles == before + 1);
    feed(*net, 1);
    CHECK(largest_difference(net->tap(0), on_host->tap(0)) < 1e-5);
  }
  cudnn_fails = false;
  use_cpu();
}

TEST_CASE("The version of cuDNN is told") { CHECK(detail::cudnn_version() == "8.9.7"); }

TEST_CASE("Images too small for cuDNN's network are an error") {
  const std::vector<FeatureStep> steps = random_weights(tiny_network()).steps;
  CHECK_THROWS_AS(detail::make_cudnn_net(steps, {5, 5}), Error);
}
