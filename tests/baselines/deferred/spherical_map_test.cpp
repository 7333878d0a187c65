// SPDX-License-Identifier: MIT
// The map over directions: closed forms, a look-up by brute force, central differences in double.
#include "baselines/deferred/spherical_map.h"

#include <algorithm>
#include <numbers>

#include "baselines/deferred/spherical_lookup.h"
#include "tests/support/check_vjp.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/random_values.h"
#include "tests/support/threads.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr double kPi = std::numbers::pi;

Vec3d direction(double u, double v) {
  return {
      std::sin(kPi * v) * std::cos(2 * kPi * u),
      std::sin(kPi * v) * std::sin(2 * kPi * u),
      std::cos(kPi * v)};
}

// The mean over the texels of level 0 that a texel of a level covers.
double covered_mean(
    std::span<const float> level0, int height, int channels, int level, int row, int column, int c
) {
  const int size = 1 << level, width = 2 * height;
  double sum = 0;
  for (int y = row * size; y < (row + 1) * size; ++y)
    for (int x = column * size; x < (column + 1) * size; ++x)
      sum += static_cast<double>(level0[static_cast<std::size_t>((y * width + x) * channels + c)]);
  return sum / (size * size);
}

// Sum over all texels of a level with the weights of a tent, longitudes taken around the circle.
double tent_value(
    std::span<const float> level0, int height, int channels, int level, double u, double v, int c
) {
  const int rows = height >> level, width = 2 * rows;
  const double y = std::clamp(v * rows - 0.5, 0.0, rows - 1.0), x = u * width - 0.5;
  double sum = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < width; ++column) {
      const double away = std::abs(x - column);
      const double around = std::min(away, width - away);
      const double weight = std::max(1 - std::abs(y - row), 0.0) * std::max(1 - around, 0.0);
      if (weight > 0) sum += weight * covered_mean(level0, height, channels, level, row, column, c);
    }
  return sum;
}

double brute_force(
    std::span<const float> level0,
    int height,
    int channels,
    double u,
    double v,
    double roughness,
    int c
) {
  const int levels = static_cast<int>(std::floor(std::log2(height)));
  const double level = std::clamp(levels * roughness, 0.0, levels - 1.0);
  const int fine = static_cast<int>(level), coarse = std::min(fine + 1, levels - 1);
  const double share = level - fine;
  return (1 - share) * tent_value(level0, height, channels, fine, u, v, c) +
         share * tent_value(level0, height, channels, coarse, u, v, c);
}

// Pixels of one row with these directions and roughnesses.
struct Queries {
  Image directions, roughness;
  explicit Queries(const std::vector<Vec3d>& d, const std::vector<double>& r)
      : directions(static_cast<int>(d.size()), 1, 3), roughness(static_cast<int>(d.size()), 1, 1) {
    for (std::size_t i = 0; i < d.size(); ++i) {
      put3(directions.data(), i, cast<float>(d[i]));
      roughness.data()[i] = static_cast<float>(r[i]);
    }
  }
};

Queries random_queries(int count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Vec3d> directions;
  std::vector<double> roughness;
  for (int i = 0; i < count; ++i) {
    const Vec3f d{rng.normal(), rng.normal(), rng.normal()};
    directions.push_back(normalize(cast<double>(d)));
    roughness.push_back(static_cast<double>(rng.uniform(-0.1f, 1.2f)));
  }
  return Queries(directions, roughness);
}

}  // namespace

TEST_CASE("A direction's place on the map is its longitude and its polar angle") {
  for (const double u : {0.0, 0.1, 0.25, 0.5, 0.9})
    for (const double v : {0.1, 0.5, 0.8}) {
      const Vec2d uv = lat_long(direction(u, v));
      CHECK(uv.x == Approx(u).margin(1e-12));
      CHECK(uv.y == Approx(v));
    }
  CHECK(lat_long(Vec3d{0, 0, 1}).y == 0);
  CHECK(lat_long(Vec3d{0, 0, -1}).y == Approx(1));
  CHECK(lat_long(Vec3f{1, -1e-12f, 0}).x == 0);  // not 1
  CHECK(lat_long(Vec3f{0, 0, 1.0000001f}).y == 0);
}

TEST_CASE("The gradient of a direction's place matches central differences, and has bounds") {
  for (const Vec3d d : {direction(0.13, 0.3), direction(0.7, 0.9), direction(0.49, 0.02)})
    check_vjp(
        {d.x, d.y, d.z},
        [](const Vector& x) {
          const Vec2d uv = lat_long(vec3(x, 0));
          return Vector{uv.x, uv.y};
        },
        [](const Vector& x, const Vector& g) {
          Vec3d dL_dd{};
          lat_long_vjp(vec3(x, 0), {g[0], g[1]}, dL_dd);
          return Vector{dL_dd.x, dL_dd.y, dL_dd.z};
        },
        // acos sees z alone, and x^2 + y^2 = 1 - z^2 of a unit vector only: along z the two are
        // one.
        1e-6
    );
  for (const double z : {1.0, -1.0}) {
    Vec3d dL_dd{};
    lat_long_vjp(Vec3d{0, 0, z}, {1, 1}, dL_dd);
    CHECK(std::isfinite(dL_dd.x + dL_dd.y + dL_dd.z));
    CHECK(length(dL_dd) < 1e3);
  }
}

TEST_CASE("Levels end with two rows, and the published map has nine") {
  CHECK(MapShape::levels_of(512) == 9);
  CHECK(MapShape::levels_of(64) == 6);
  CHECK(MapShape::levels_of(2) == 1);
  for (const int height : {8, 64, 512}) {
    const MapShape shape{height, 1, MapShape::levels_of(height)};
    CHECK(shape.rows(shape.levels - 1) == 2);
    CHECK(shape.first_texel(1) == static_cast<std::size_t>(2 * height * height));
  }
}

TEST_CASE("Roughness chooses the level, clamped at both ends") {
  CHECK(level_of_roughness(0.5, 9).first == 4);
  CHECK(level_of_roughness(0.5, 9).weight == Approx(0.5));
  CHECK(level_of_roughness(0.5, 9).slope == 9);
  for (const double beyond : {8.0 / 9, 1.0, 7.0}) {
    CHECK(level_of_roughness(beyond, 9).first == 8);
    CHECK(level_of_roughness(beyond, 9).weight == 0);
    CHECK(level_of_roughness(beyond, 9).slope == 0);
  }
  CHECK(level_of_roughness(-1.0, 9).first == 0);
  CHECK(level_of_roughness(-1.0, 9).slope == 0);
}

TEST_CASE("A constant map is that constant in every direction, a zero direction has nothing") {
  SphericalLookup map(8, 2);
  FloatArray level0(map.num_values());
  for (std::size_t i = 0; i < level0.size(); ++i) level0[i] = i % 2 == 0 ? 3.0f : -0.5f;
  map.set_texels(level0);
  Queries q = random_queries(200, 1);
  put3(q.directions.data(), 7, {0, 0, 0});
  const Image& values = map.look_up(q.directions, q.roughness);
  for (int i = 0; i < 200; ++i) {
    CHECK(values.at(i, 0, 0) == Approx(i == 7 ? 0 : 3));
    CHECK(values.at(i, 0, 1) == Approx(i == 7 ? 0 : -0.5));
  }
}

TEST_CASE("Texel centres give texels, and longitude wraps") {
  const int height = 4, width = 8;
  SphericalLookup map(height, 1);
  const FloatArray level0 = random_array(map.num_values(), 4);
  map.set_texels(level0);
  std::vector<Vec3d> d;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      d.push_back(direction((column + 0.5) / width, (row + 0.5) / height));
  const Queries q(d, std::vector<double>(d.size(), 0.0));
  const Image& values = map.look_up(q.directions, q.roughness);
  for (std::size_t i = 0; i < d.size(); ++i)
    CHECK(values.data()[i] == Approx(level0[i]).margin(1e-5));
  // Half way between the last and the first column, from either side.
  for (const double u : {1e-7, 1 - 1e-7}) {
    const Queries seam({direction(u, 0.625)}, {0});
    const double mean = 0.5 * static_cast<double>(level0[2 * 8] + level0[2 * 8 + 7]);
    CHECK(map.look_up(seam.directions, seam.roughness).at(0, 0) == Approx(mean).margin(1e-5));
  }
}

TEST_CASE("Look-ups are those of brute force over all texels") {
  for (const int height : {16, 12}) {
    SphericalLookup map(height, 3);
    const FloatArray level0 = random_array(map.num_values(), 5);
    map.set_texels(level0);
    const Queries q = random_queries(300, 6);
    const Image& values = map.look_up(q.directions, q.roughness);
    for (int i = 0; i < 300; ++i) {
      const Vec3d d = cast<double>(get3(q.directions.data(), static_cast<std::size_t>(i)));
      const double u = std::atan2(d.y, d.x) / (2 * kPi), v = std::acos(d.z) / kPi;
      for (int c = 0; c < 3; ++c)
        CHECK(
            static_cast<double>(values.at(i, 0, c)) ==
            Approx(brute_force(
                       level0,
                       height,
                       3,
                       u < 0 ? u + 1 : u,
                       v,
                       static_cast<double>(q.roughness.at(i, 0)),
                       c
                   ))
                .margin(2e-5)
        );
    }
  }
}

TEST_CASE("The gradient of a look-up by place and level matches central differences") {
  const MapShape shape{16, 1, 4};
  const FloatArray floats = random_array(shape.first_texel(4), 7);
  const Vector texels(floats.begin(), floats.end());
  // u, v, roughness away from the middles of texels, where bilinear values have kinks.
  for (const Vector& x :
       {Vector{0.27, 0.43, 0.3},
        {0.997, 0.61, 0.55},
        {0.005, 0.2, 0.1},
        {0.6, 0.01, 0.4},
        {0.6, 0.5, 0.9}}) {
    const auto lookup = [&](const Vector& at) {
      const auto level = level_of_roughness(at[2], shape.levels);
      const Vec2d uv{at[0], at[1]};
      const int next = std::min(level.first + 1, shape.levels - 1);
      return MapLookup<double>{
          uv,
          level,
          LevelTap<double>::at(shape, level.first, uv),
          LevelTap<double>::at(shape, next, uv)};
    };
    check_vjp(
        x,
        [&](const Vector& at) { return Vector{map_value(texels.data(), shape, lookup(at), 0)}; },
        [&](const Vector& at, const Vector& g) {
          const MapLookup<double> l = lookup(at);
          Vec2d dL_duv{};
          double dL_dlevel = 0;
          map_value_vjp(texels.data(), shape, l, 0, g[0], dL_duv, dL_dlevel);
          return Vector{dL_duv.x, dL_duv.y, dL_dlevel * l.level.slope};
        }
    );
  }
}

TEST_CASE("The gradient of texels is the one of brute force") {
  const int height = 12, channels = 2;
  SphericalLookup map(height, channels);
  FloatArray level0 = random_array(map.num_values(), 8);
  map.set_texels(level0);
  const Queries q = random_queries(60, 9);
  map.look_up(q.directions, q.roughness);
  Image g(60, 1, channels), dL_dd, dL_dr;
  const FloatArray values = random_array(g.values().size(), 10);
  std::copy(values.begin(), values.end(), g.data());
  FloatArray gradient(map.num_values(), 1.0f);  // is added to
  map.look_up_vjp(g, dL_dd, dL_dr, gradient);
  // Values are linear in texels: the gradient of texel i is the loss of the i-th unit map.
  for (std::size_t i = 0; i < level0.size(); ++i) {
    FloatArray unit(level0.size());
    unit[i] = 1;
    double expected = 1;
    const int c = static_cast<int>(i % channels);
    for (int p = 0; p < 60; ++p) {
      const Vec3d d = cast<double>(get3(q.directions.data(), static_cast<std::size_t>(p)));
      const double u = std::atan2(d.y, d.x) / (2 * kPi), v = std::acos(d.z) / kPi;
      expected +=
          static_cast<double>(g.at(p, 0, c)) * brute_force(
                                                   unit,
                                                   height,
                                                   channels,
                                                   u < 0 ? u + 1 : u,
                                                   v,
                                                   static_cast<double>(q.roughness.at(p, 0)),
                                                   c
                                               );
    }
    CHECK(static_cast<double>(gradient[i]) == Approx(expected).margin(1e-4));
  }
}

TEST_CASE("Directions and roughness get the formulas' gradients, zero directions none") {
  SphericalLookup map(16, 3);
  const FloatArray level0 = random_array(map.num_values(), 11);
  map.set_texels(level0);
  Queries q = random_queries(50, 12);
  put3(q.directions.data(), 3, {0, 0, 0});
  map.look_up(q.directions, q.roughness);
  const Image g(50, 1, 3, 1.0f);
  Image dL_dd, dL_dr;
  FloatArray dL_dtexels(map.num_values());
  map.look_up_vjp(g, dL_dd, dL_dr, dL_dtexels);
  CHECK(length(get3(dL_dd.data(), 3)) == 0);
  CHECK(dL_dr.at(3, 0) == 0);
  // Sum of the channels, moved along the roughness and around the axis, in float.
  const auto sum_at = [&](int i, double turn, double more) {
    const Vec3d d = cast<double>(get3(q.directions.data(), static_cast<std::size_t>(i)));
    const Vec3d moved{
        std::cos(turn) * d.x - std::sin(turn) * d.y,
        std::sin(turn) * d.x + std::cos(turn) * d.y,
        d.z};
    const Vec2d uv = lat_long(moved);
    double sum = 0;
    for (int c = 0; c < 3; ++c)
      sum += brute_force(
          level0, 16, 3, uv.x, uv.y, static_cast<double>(q.roughness.at(i, 0)) + more, c
      );
    return sum;
  };
  int checked = 0;
  for (int i = 0; i < 50; ++i) {
    if (i == 3) continue;
    const Vec3d d = cast<double>(get3(q.directions.data(), static_cast<std::size_t>(i)));
    const Vec3d along{-d.y, d.x, 0};
    const double h = 1e-5, h2 = 2e-5;
    const double wide = (sum_at(i, h2, 0) - sum_at(i, -h2, 0)) / (2 * h2);
    const double slope = (sum_at(i, h, 0) - sum_at(i, -h, 0)) / (2 * h);
    const double by_roughness = (sum_at(i, 0, h) - sum_at(i, 0, -h)) / (2 * h);
    const double wide_roughness = (sum_at(i, 0, h2) - sum_at(i, 0, -h2)) / (2 * h2);
    // Not across a kink.
    if (std::abs(wide - slope) > 1e-4 || std::abs(wide_roughness - by_roughness) > 1e-4) continue;
    ++checked;
    CHECK(
        dot(cast<double>(get3(dL_dd.data(), static_cast<std::size_t>(i))), along) ==
        Approx(slope).epsilon(2e-3).margin(2e-3)
    );
    CHECK(static_cast<double>(dL_dr.at(i, 0)) == Approx(by_roughness).epsilon(2e-3).margin(2e-3));
  }
  CHECK(checked > 40);
}

TEST_CASE("A map over directions is the same for any number of threads and on a GPU") {
  const auto run = [] {
    SphericalLookup map(32, 16);
    map.set_texels(random_array(map.num_values(), 13));
    const Queries q = random_queries(5000, 14);
    Image g(5000, 1, 16), dL_dd, dL_dr;
    const FloatArray noise = random_array(g.values().size(), 15);
    std::copy(noise.begin(), noise.end(), g.data());
    FloatArray dL_dtexels(map.num_values());
    std::map<std::string, std::vector<float>> results;
    results["values"] = read(map.look_up(q.directions, q.roughness));
    map.look_up_vjp(g, dL_dd, dL_dr, dL_dtexels);
    results["directions"] = read(dL_dd);
    results["roughness"] = read(dL_dr);
    results["texels"] = read(dL_dtexels);
    return results;
  };
  check_same_as_cpu(1e-5, run);
  CHECK(with_threads(4, run) == with_threads(1, run));
}

TEST_CASE("Maps of no size and texels of another are refused") {
  CHECK_THROWS_WITH(SphericalLookup(1, 3), Catch::Contains("1 rows of 3 channels"));
  CHECK_THROWS_WITH(SphericalLookup(8, 0), Catch::Contains("8 rows of 0 channels"));
  SphericalLookup map(8, 1);
  CHECK_THROWS_WITH(map.set_texels(FloatArray(5)), Catch::Contains("5 values, expected 128"));
  Image a, b;
  FloatArray dL_dtexels(128);
  CHECK_THROWS_WITH(map.look_up_vjp(a, a, b, dL_dtexels), Catch::Contains("nothing was looked up"));
}
