// SPDX-License-Identifier: MIT
// What a pixel is in Ref-GS and RT-Splatting: closed forms, central differences in double.
#include "baselines/ref_gs_kernels.h"
#include "baselines/rt_splatting_kernels.h"
#include "tests/support/check_loss.h"
#include "tests/support/check_vjp.h"

using namespace glint;
using namespace glint::test;

namespace {

RtPixel<double> pixel_of(const Vector& x) {
  return {vec3(x, 0), vec3(x, 3), x[6], x[7], vec3(x, 8), x[11], 0.8};
}
Vector values_of(const RtPixel<double>& p) {
  Vector x;
  push(x, p.transmission);
  push(x, p.scattered);
  x.insert(x.end(), {p.transmissivity, p.reflectance});
  push(x, p.specular);
  x.push_back(p.attenuation);
  return x;
}

Image surface_of(ImageSize size) { return random_map<float>(size, kRtChannels, 0.1f, 0.9f, 3); }

}  // namespace

TEST_CASE("Ref-GS's colour is sRGB of albedo and specular over its background") {
  const Vec3d background{0.3, 0, 1};
  const Vec3d color = deferred_color(0.5, background, {0.1, 0.2, 0.0}, {std::log(0.4), -50.0, 3.0});
  CHECK(color.x == Approx(0.5 * displayed(0.5) + 0.15));
  CHECK(color.y == Approx(0.5 * displayed(0.2)));
  CHECK(color.z == Approx(1));  // clamped
}

TEST_CASE("The gradient of Ref-GS's colour matches central differences") {
  const Vec3d background{0.3, 0.9, 0.1};
  check_vjp(
      {0.1, 0.3, 0.02, -1.5, -2.0, -0.7, 0.8},
      [&](const Vector& x) {
        Vector y;
        push(y, deferred_color(x[6], background, vec3(x, 0), vec3(x, 3)));
        return y;
      },
      [&](const Vector& x, const Vector& g) {
        Vec3d dL_dalbedo{}, dL_dx{};
        double dL_dalpha = 0;
        deferred_color_vjp(
            x[6], background, vec3(x, 0), vec3(x, 3), vec3(g, 0), dL_dalpha, dL_dalbedo, dL_dx
        );
        Vector result;
        push(result, dL_dalbedo);
        push(result, dL_dx);
        result.push_back(dL_dalpha);
        return result;
      }
  );
  Vec3d dL_dalbedo{}, dL_dx{};  // clamped colours have none
  double dL_dalpha = 0;
  deferred_color_vjp(
      0.8, background, {2, 2, 2}, Vec3d{6, 0, 0}, {1, 1, 1}, dL_dalpha, dL_dalbedo, dL_dx
  );
  CHECK(length(dL_dalbedo) + length(dL_dx) == 0);
}

TEST_CASE("RT-Splatting's colour by stages") {
  RtPixel<double> p;
  p.transmission = {0.2, 0.4, 0.6};
  p.scattered = {1, 0, 0.5};
  p.transmissivity = 0.75;
  p.reflectance = 0.5;
  p.specular = {0, std::log(2), -40};
  p.attenuation = 0;  // sigmoid: a half
  CHECK(rt_color(p, RtStage::kTransmission).y == 0.4);
  CHECK(rt_color(p, RtStage::kNoSpecular).x == Approx(0.75 * 0.2 + 0.25));
  p.coverage = 0.8;
  const double a = 1 - 0.5 * 0.8;
  CHECK(rt_color(p, RtStage::kAll).x == Approx(a * 0.4 + 0.5 * 0.5));
  CHECK(rt_color(p, RtStage::kAll).y == Approx(a * 0.3 + 0.5 * 1.0));
  CHECK(rt_color(p, RtStage::kAll).z == Approx(a * 0.575).margin(1e-6));
}

TEST_CASE("The gradient of RT-Splatting's colour matches central differences") {
  const Vector x = {0.2, 0.5, 0.7, 0.9, 0.1, 0.4, 0.3, 0.6, -0.5, 0.2, -1.1, 0.4};
  for (const RtStage stage : {RtStage::kTransmission, RtStage::kNoSpecular, RtStage::kAll})
    check_vjp(
        x,
        [&](const Vector& at) {
          Vector y;
          push(y, rt_color(pixel_of(at), stage));
          return y;
        },
        [&](const Vector& at, const Vector& g) {
          return values_of(rt_color_vjp(pixel_of(at), stage, vec3(g, 0), {1, 1, 1}));
        }
    );
}

TEST_CASE("The transmitted part lets a share of its gradient through, the others all of theirs") {
  const RtPixel<double> p =
      pixel_of({0.2, 0.5, 0.7, 0.9, 0.1, 0.4, 0.3, 0.6, -0.5, 0.2, -1.1, 0.4});
  const Vec3d g{0.3, -0.7, 1.1}, kept{0.1, 0.5, 0.8};
  for (const RtStage stage : {RtStage::kNoSpecular, RtStage::kAll}) {
    // What changes with the transmitted part alone is the colour over black, without light.
    RtPixel<double> alone = p;
    alone.scattered = {};
    const Vector all = values_of(rt_color_vjp(p, stage, g, {1, 1, 1}));
    const Vector some = values_of(rt_color_vjp(p, stage, g, kept));
    const Vector lost =
        values_of(rt_color_vjp(alone, stage, hadamard(Vec3d{1, 1, 1} - kept, g), {1, 1, 1}));
    for (const std::size_t i : {0, 1, 2, 6, 11}) CHECK(some[i] == Approx(all[i] - lost[i]));
    for (const std::size_t i : {3, 4, 5, 7, 8, 9, 10}) CHECK(some[i] == all[i]);
  }
}

TEST_CASE(
    "What is transmitted keeps its whole gradient where light is even, and e^(-4 std) of it "
    "elsewhere"
) {
  const ImageSize size = GENERATE(ImageSize{9, 7}, ImageSize{1, 2});
  Image surface = surface_of(size), kept(size.width, size.height, 3);
  Image light(size.width, size.height, 3, 0.3f);
  const RtKeptShare even{light, surface.data(), kept.data()};
  for (std::size_t i = 0; i < light.num_pixels(); ++i) even(i);
  for (const float k : kept.values()) CHECK(k == 1);
  light = random_map<float>(size, 3, 0, 2, 4);
  const auto fold = [](int at, int count) {
    if (count == 1) return 0;
    return at < 0 ? -at : at >= count ? 2 * (count - 1) - at : at;
  };
  const RtKeptShare noisy{light, surface.data(), kept.data()};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      noisy(static_cast<std::size_t>(size.width * y + x));
      for (int c = 0; c < 3; ++c) {
        double weights = 0, mean = 0, variance = 0;
        for (const bool second : {false, true}) {
          for (int k = 0; k < 9; ++k) {
            const int u = fold(x + k % 3 - 1, size.width), v = fold(y + k / 3 - 1, size.height);
            const double w = 1 - static_cast<double>(surface.at(u, v, kRtOpacity));
            const auto value = static_cast<double>(light.at(u, v, c));
            if (second) variance += w * (value - mean) * (value - mean) / 9;
            if (!second) weights += w, mean += w * value;
          }
          if (!second) mean /= weights;
        }
        CHECK(kept.at(x, y, c) == Approx(std::exp(-4 * std::sqrt(variance))).epsilon(1e-4));
      }
    }
}

TEST_CASE("Mask losses are what they say, with their gradients") {
  const ImageSize size{5, 4};
  Image surface = surface_of(size), mask(5, 4, 1);
  for (std::size_t i = 0; i < 9; ++i) mask.data()[2 * i] = 1;
  const float opacity_weight = 0.5f, outside_weight = 2.75f, scatter_weight = 0.3f;
  const auto total = [&] {
    double loss = 0, count = 0, mean[4] = {}, scatter = 0;
    const int channels[4] = {0, 1, 2, kRtTransmissivity};
    for (int pass = 0; pass < 2; ++pass)
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) {
          const bool inside = mask.at(x, y) > 0;
          for (int k = 0; k < 4; ++k) {
            const auto value = static_cast<double>(surface.at(x, y, channels[k]));
            if (inside && pass == 0) mean[k] += value / 9;
            if (inside && pass == 1) scatter += std::pow(value - mean[k], 2) / (k < 3 ? 3 : 1);
          }
          if (pass == 0) continue;
          count += inside;
          const auto o = static_cast<double>(surface.at(x, y, kRtOpacity));
          const auto t = static_cast<double>(surface.at(x, y, kRtTransmissivity));
          loss -= 0.5 * (inside ? std::log(1 - o) : std::log(o));
          if (!inside) loss -= 2.75 / 11 * std::log(1 - t);
        }
    CHECK(count == 9);
    return std::pair(loss, scatter);
  };
  const RtMoments moments = sum_kernel(size, RtMaskMoments{surface, mask});
  RtInside inside{};
  RtFindInside{&moments, 20, &inside}(0);
  CHECK(moments.count == 9);
  CHECK(moments.scatter() == Approx(total().second));
  Image gradient(5, 4, kRtChannels);
  const RtMaskLoss kernel{
      surface, mask, &inside, opacity_weight, outside_weight, scatter_weight, gradient.ref()};
  CHECK(sum_kernel(size, kernel) == Approx(total().first).epsilon(1e-5));
  for (std::size_t i = 0; i < surface.values().size(); ++i) {
    const float at = surface.data()[i], h = 1.0f / 1024;
    const auto loss = [&] {
      const auto [bce, scatter] = total();
      return bce + 0.3 * scatter;
    };
    surface.data()[i] = at + h;
    const double above = loss();
    surface.data()[i] = at - h;
    const double slope = (above - loss()) / (2 * static_cast<double>(h));
    surface.data()[i] = at;
    CHECK(static_cast<double>(gradient.data()[i]) == Approx(slope).epsilon(2e-3).margin(1e-4));
  }
}
