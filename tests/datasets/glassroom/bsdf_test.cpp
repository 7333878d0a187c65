// SPDX-License-Identifier: MIT
#include "datasets/glassroom/bsdf.h"

#include <catch2/catch.hpp>
#include <set>

#include "datasets/glassroom/fresnel.h"
#include "datasets/glassroom/ggx.h"
#include "datasets/glassroom/path_tracer.h"
#include "datasets/glassroom/sampler.h"
#include "tests/datasets/glassroom/trace_scenes.h"

using namespace glint;
using namespace glint::path_tracing;

namespace {

// Fresnel by angles (sine and tangent laws), unlike the cosine form under test.
struct SlabTruth {
  double r_s, r_p;
};
SlabTruth fresnel_by_angles(double cos_i, double ior) {
  const double i = std::acos(cos_i), t = std::asin(std::sin(i) / ior);
  const double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
  return {s * s, p * p};
}

// Every order of inter-reflection inside the slab, one by one.
double slab_by_orders(double r) {
  double sum = r, inside = (1 - r) * (1 - r) * r;
  for (int order = 0; order < 2000; ++order, inside *= r * r) sum += inside;
  return sum;
}

Vec3f direction_at(float cosine, float phi) {
  const float s = std::sqrt(1 - cosine * cosine);
  return {s * std::cos(phi), s * std::sin(phi), cosine};
}

struct Integral {
  double reflectance = 0, pdf = 0;
};

// Midpoint rule over the hemisphere in (cos, phi), cells squeezed towards the horizon and, through
// kCells, fine enough for alpha >= 0.1.
Integral integrate(const Bsdf& bsdf, Vec3f wo) {
  constexpr int kCos = 1500, kPhi = 720;
  Integral sum;
  for (int i = 0; i < kCos; ++i)
    for (int j = 0; j < kPhi; ++j) {
      const float c = (static_cast<float>(i) + 0.5f) / kCos;
      const BsdfValue v =
          bsdf.evaluate(wo, direction_at(c, 2 * kPi * (static_cast<float>(j) + 0.5f) / kPhi));
      sum.reflectance += static_cast<double>(v.f_cos.x);
      sum.pdf += static_cast<double>(v.pdf);
    }
  const double cell = 2 * std::numbers::pi / (kCos * kPhi);
  return {sum.reflectance * cell, sum.pdf * cell};
}

// Mean weight of sample() on a 256 x 256 grid of random numbers, and the share of absorbed samples.
Integral integrate_samples(const Bsdf& bsdf, Vec3f wo) {
  constexpr int kCells = 256;
  Integral sum;
  for (int i = 0; i < kCells * kCells; ++i) {
    const auto x = static_cast<float>(i % kCells), y = static_cast<float>(i / kCells);
    const BsdfSample s = bsdf.sample(wo, {(x + 0.5f) / kCells, (y + 0.5f) / kCells});
    sum.reflectance += static_cast<double>(s.weight.x) / (kCells * kCells);
    sum.pdf += (s.pdf > 0 ? 1.0 : 0.0) / (kCells * kCells);
  }
  return sum;
}

}  // namespace

TEST_CASE("Fresnel reflectance equals the sine and tangent laws") {
  for (const double ior : {1.1, 1.33, 1.52, 2.4})
    for (const double cosine : {0.05, 0.3, 0.5, 0.8, 0.99}) {
      const SlabTruth truth = fresnel_by_angles(cosine, ior);
      const auto r =
          fresnel_dielectric_polarized(static_cast<float>(cosine), static_cast<float>(ior));
      CHECK(double(r.s) == Approx(truth.r_s).epsilon(1e-4).margin(1e-6));
      CHECK(double(r.p) == Approx(truth.r_p).epsilon(1e-4).margin(1e-6));
    }
}

TEST_CASE("Slab reflectance is the sum of all orders, averaged over polarisations") {
  for (const double ior : {1.1, 1.52, 2.4})
    for (const double cosine : {0.02, 0.1, 0.4, 0.7, 0.99}) {
      const SlabTruth r = fresnel_by_angles(cosine, ior);
      const double truth = 0.5 * (slab_by_orders(r.r_s) + slab_by_orders(r.r_p));
      CHECK(
          double(thin_slab_reflectance(float(cosine), float(ior))) == Approx(truth).epsilon(1e-4)
      );
    }
}

TEST_CASE("Slab reflectance has its closed form at normal incidence and is total at grazing") {
  const float r = std::pow((1.5f - 1) / (1.5f + 1), 2.0f);
  CHECK(thin_slab_reflectance(1, 1.5f) == Approx(2 * r / (1 + r)).epsilon(1e-6));
  CHECK(thin_slab_reflectance(0, 1.5f) == Approx(1).epsilon(1e-6));
  CHECK(thin_slab_reflectance(0.5f, 1) == Approx(0).margin(1e-6));
}

TEST_CASE("Every opaque material with albedo 1 reflects all light of a white furnace") {
  // Tolerance: tabulated directional albedo (64 intervals) and this quadrature, 0.3 % of the
  // energy.
  for (const auto kind :
       {MaterialKind::kDiffuse, MaterialKind::kRoughConductor, MaterialKind::kRoughPlastic})
    for (const float roughness : {0.35f, 0.6f, 1.0f})
      for (const float cosine : {0.15f, 0.5f, 0.9f, 1.0f}) {
        const MaterialModel model = prepare_material(test::glossy(kind, 1, roughness));
        const Bsdf bsdf(model, {1, 1, 1});
        CAPTURE(int(kind), roughness, cosine);
        CHECK(integrate(bsdf, direction_at(cosine, 0.3f)).reflectance == Approx(1).margin(3e-3));
      }
}

TEST_CASE("No material reflects more than it receives") {
  for (const auto kind : {MaterialKind::kRoughConductor, MaterialKind::kRoughPlastic})
    for (const float albedo : {0.0f, 0.3f, 0.8f})
      for (const float cosine : {0.1f, 0.6f, 1.0f}) {
        const MaterialModel model = prepare_material(test::glossy(kind, albedo, 0.5f));
        const double r =
            integrate(Bsdf(model, {albedo, albedo, albedo}), direction_at(cosine, 1)).reflectance;
        CAPTURE(int(kind), albedo, cosine, r);
        CHECK(r < 1.003);
        CHECK(r > double(albedo) * 0.9);
      }
}

TEST_CASE("Samples of a BSDF have its integral and its density") {
  for (const auto kind :
       {MaterialKind::kDiffuse, MaterialKind::kRoughConductor, MaterialKind::kRoughPlastic})
    for (const float roughness : {0.4f, 0.8f})
      for (const float cosine : {0.2f, 0.8f}) {
        const MaterialModel model = prepare_material(test::glossy(kind, 0.6f, roughness));
        const Bsdf bsdf(model, {0.6f, 0.6f, 0.6f});
        const Vec3f wo = direction_at(cosine, 2);
        const Integral quadrature = integrate(bsdf, wo), samples = integrate_samples(bsdf, wo);
        CAPTURE(int(kind), roughness, cosine);
        CHECK(samples.reflectance == Approx(quadrature.reflectance).epsilon(3e-3));
        CHECK(samples.pdf == Approx(quadrature.pdf).epsilon(3e-3));
      }
}

TEST_CASE("Diffuse and plastic reflection is reciprocal") {
  const MaterialModel model =
      prepare_material(test::glossy(MaterialKind::kRoughPlastic, 0.6f, 0.5f));
  const Bsdf bsdf(model, {0.6f, 0.6f, 0.6f});
  const Vec3f a = direction_at(0.3f, 0.1f), b = direction_at(0.8f, 2.5f);
  CHECK(
      bsdf.evaluate(a, b).f_cos.x / b.z == Approx(bsdf.evaluate(b, a).f_cos.x / a.z).epsilon(1e-4)
  );
}

TEST_CASE("A frame is orthonormal and right-handed for any normal") {
  Rng rng(3);
  for (int i = 0; i < 200; ++i) {
    Vec3f n = normalize(Vec3f{rng.normal(), rng.normal(), rng.normal()});
    if (i == 0) n = {0, 0, -1};
    const Frame frame(n);
    CHECK(length(cross(frame.x, frame.y) - n) < 1e-5f);
    CHECK(std::abs(dot(frame.x, frame.y)) < 1e-5f);
    CHECK(length(frame.to_world(frame.to_local({1, 2, 3})) - Vec3f{1, 2, 3}) < 1e-5f);
  }
}

TEST_CASE("The first pairs of a pixel fill every elementary interval once") {
  constexpr int kSamples = 64;
  for (int pair = 0; pair < Sampler::kStratifiedPairs; ++pair)
    for (int log_columns = 0; log_columns <= 6; ++log_columns) {
      const int columns = 1 << log_columns, rows = kSamples / columns;
      std::set<int> cells;
      for (int i = 0; i < kSamples; ++i) {
        Sampler sampler(pixel_key(1, 2, 3, 0), static_cast<std::uint32_t>(i));
        Vec2f u{};
        for (int k = 0; k <= pair; ++k) u = sampler.next_2d();
        cells.insert(
            static_cast<int>(u.x * float(columns)) * rows + static_cast<int>(u.y * float(rows))
        );
      }
      CAPTURE(pair, columns);
      CHECK(cells.size() == kSamples);
    }
}

TEST_CASE("Pairs of one pixel and pixels of one image are uncorrelated") {
  // Correlation of n uniform pairs has standard deviation 1 / sqrt(n).
  constexpr int kSamples = 64, kPixels = 256;
  double between_pairs = 0, between_pixels = 0;
  for (std::uint64_t pixel = 0; pixel < kPixels; ++pixel)
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      Sampler here(pixel_key(0, 0, pixel, 0), i), there(pixel_key(0, 0, pixel + 1, 0), i);
      const Vec2f a = here.next_2d(), b = here.next_2d(), c = there.next_2d();
      between_pairs += double((a.x - 0.5f) * (b.x - 0.5f) + (a.y - 0.5f) * (b.y - 0.5f));
      between_pixels += double((a.x - 0.5f) * (c.x - 0.5f) + (a.y - 0.5f) * (c.y - 0.5f));
    }
  const double scale = 6.0 / (kSamples * kPixels);  // two products of variance 1/12 each
  CHECK(std::abs(between_pairs * scale) < 4 / std::sqrt(2.0 * kSamples * kPixels));
  CHECK(std::abs(between_pixels * scale) < 4 / std::sqrt(2.0 * kSamples * kPixels));
}
