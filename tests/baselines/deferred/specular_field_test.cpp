// SPDX-License-Identifier: MIT
// Reflections from a map of directions: their formulas in double, the whole by central differences.
#include "baselines/deferred/specular_field.h"

#include <cmath>
#include <cstring>

#include "glint/render/tone.h"
#include "tests/support/check_loss.h"
#include "tests/support/check_vjp.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/random_scene.h"
#include "tests/support/temp_folder.h"
#include "tests/support/threads.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{6, 5};
constexpr int kChannels = 9;              // of features
constexpr SpecularChannels kWhere{3, 5};  // roughness, feature
constexpr std::size_t kOutputs = 2;

SpecularFieldConfig small_config() {
  SpecularFieldConfig config;
  config.map_height = 8;
  config.map_channels = 3;
  config.hidden = 8;
  return config;
}

struct Fixture {
  Camera camera;
  RasterOutput surface;
  SpecularField field{small_config(), {0.1f, -0.2f}, 4};
  Image g = random_map<float>(kSize, kOutputs, -1, 1, 9);

  explicit Fixture(std::uint64_t seed = 1) {
    Rng rng(seed);
    camera = random_camera(rng, kSize);
    surface.features = random_map<float>(kSize, kChannels, 0.1f, 0.9f, seed);
    surface.alpha = random_map<float>(kSize, 1, 0.5f, 1, seed + 1);
    surface.normal = random_map<float>(kSize, 3, -0.3f, 0.3f, seed + 2);
    for (std::size_t i = 0; i < surface.normal.num_pixels(); ++i)
      surface.normal.data()[3 * i + 2] -= 0.7f;
    surface.alpha.data()[2] = 0.01f;  // not shaded
    for (float& value : field.map().values) value = rng.uniform(-1, 1);
    field.map_changed();
    g.data()[2 * kOutputs] = g.data()[2 * kOutputs + 1] = 0;
  }
  double loss() {
    const FloatArray& y = field.forward(camera, surface, kWhere);
    double sum = 0;
    for (std::size_t i = 0; i < y.size(); ++i)
      sum += static_cast<double>(g.data()[i]) * static_cast<double>(y[i]);
    return sum;
  }
  RasterOutputGradient gradient() {
    loss();
    RasterOutputGradient result;
    result.features = Image(kSize.width, kSize.height, kChannels);
    result.normal = Image(kSize.width, kSize.height, 3);
    field.backward(g.array(), result);
    return result;
  }
  // In float: where the slopes to both sides and over two steps agree, and so no texel's middle or
  // ReLU lies between.
  template <class Changed>
  void check(std::span<float> values, std::span<const float> actual, Changed&& changed) {
    constexpr float kStep = 2e-3f;
    const double here = loss();
    std::size_t checked = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto slope = [&](float h) {
        const float at = values[i];
        values[i] = at + h;
        changed();
        const double there = loss();
        values[i] = at;
        changed();
        return (there - here) / static_cast<double>(h);
      };
      const double up = slope(kStep), down = slope(-kStep), middle = (up + down) / 2;
      const double wide = (slope(2 * kStep) + slope(-2 * kStep)) / 2;
      if (std::abs(up - down) > 0.05 * std::abs(middle) + 5e-3) continue;
      if (std::abs(wide - middle) > 0.01 * std::abs(middle) + 1e-3) continue;
      ++checked;
      CHECK(static_cast<double>(actual[i]) == Approx(middle).epsilon(0.03).margin(4e-3));
    }
    CHECK(checked > values.size() / 2);
  }
};

}  // namespace

TEST_CASE("A feature's direction and its gradient") {
  const Vector x = {0.3, -0.2, 0.5, 0.1};
  const auto direction = FeatureDirection<double>::of(x.data());
  CHECK(direction.norm == Approx(std::sqrt(0.39)));
  for (const Vector& at : {x, Vector{1e-4, -2e-4, 0, 3e-4}})  // the latter below the shortest
    check_vjp(
        at,
        [](const Vector& f) {
          const auto d = FeatureDirection<double>::of(f.data());
          return Vector(d.unit, d.unit + 4);
        },
        [](const Vector& f, const Vector& g) {
          Vector dL_df(4);
          FeatureDirection<double>::of(f.data()).vjp(g.data(), dL_df.data());
          return dL_df;
        },
        at == x ? 1e-7 : 1e-5
    );
  const Vector zero(4);
  CHECK(FeatureDirection<double>::of(zero.data()).unit[0] == 0);
}

TEST_CASE("The network's input is the outer product and the code, with its gradient") {
  constexpr int kCodes = 3;
  const auto direction_of = [](const Vector& x) {
    FeatureDirection<double> d{};
    for (int k = 0; k < 4; ++k) d.unit[k] = x[kCodes + k];
    return d;
  };
  const auto f = [&](const Vector& x) {
    Vector y(kCodes * 5);
    specular_input(x.data(), kCodes, direction_of(x), y.data());
    return y;
  };
  const Vector x = random_inputs(kCodes + 4, -1, 1, 2);
  const Vector y = f(x);
  CHECK(y[1 * 4 + 2] == x[1] * x[kCodes + 2]);
  CHECK(y[12 + 2] == x[2]);
  check_vjp(x, f, [&](const Vector& at, const Vector& g) {
    Vector dL_dx(kCodes + 4);
    specular_input_vjp(
        at.data(), kCodes, direction_of(at), g.data(), dL_dx.data(), dL_dx.data() + kCodes
    );
    return dL_dx;
  });
}

TEST_CASE("The sRGB curve is that of the standard, and has its gradient where it is not clamped") {
  CHECK(displayed(0.0) == 0);
  CHECK(displayed(1.0) == Approx(1));
  CHECK(displayed(0.5) == Approx(0.7353569830524495));
  CHECK(displayed(0.001) == Approx(0.01292));
  CHECK(displayed(-1.0) == 0);
  CHECK(displayed(3.0) == Approx(1));
  for (const double x : {0.001, 0.01, 0.3, 0.9})
    check_vjp(
        {x},
        [](const Vector& v) { return Vector{displayed(v[0])}; },
        [](const Vector& v, const Vector& g) { return Vector{displayed_vjp(v[0], g[0])}; },
        1e-5
    );
  CHECK(displayed_vjp(1.2, 1.0) == 0);
  CHECK(displayed_vjp(-0.2, 1.0) == 0);
}

TEST_CASE("Mirrored directions leave the surface, and faint pixels have none") {
  Fixture f;
  f.loss();
  for (std::size_t i = 0; i < kSize.num_pixels(); ++i) {
    const Vec3d world = cast<double>(get3(f.field.directions().data(), i));
    const Vec3f d = cast<float>(f.camera.rotation_cam_from_world * world);
    if (i == 2) {
      CHECK(length(d) == 0);
      continue;
    }
    const Vec3f n = normalize(get3(f.surface.normal.data(), i));
    const int x = static_cast<int>(i) % kSize.width, y = static_cast<int>(i) / kSize.width;
    const Vec3f ray = cast<float>(normalize(f.camera.ray_in_cam(x + 0.5, y + 0.5)));
    CHECK(length(d) == Approx(1).epsilon(1e-5));
    CHECK(dot(d, n) == Approx(-dot(ray, n)).margin(1e-5));   // angle in = angle out
    CHECK(dot(d, cross(ray, n)) == Approx(0).margin(1e-5));  // in one plane
  }
}

TEST_CASE("Gradients reach roughness, feature and normal, the map and the network") {
  for (const std::uint64_t seed : {1, 2}) {
    Fixture f(seed);
    const RasterOutputGradient g = f.gradient();
    const FloatArray dL_dmap = f.field.map().gradient;
    const FloatArray dL_dnetwork = f.field.network().parameters().gradient;
    const auto nothing = [] {};
    f.check(f.surface.features.values(), g.features.values(), nothing);
    f.check(f.surface.normal.values(), g.normal.values(), nothing);
    f.check(f.field.map().values, dL_dmap, [&] { f.field.map_changed(); });
    f.check(f.field.network().parameters().values, dL_dnetwork, nothing);
    double norm = 0;
    for (std::size_t i = 0; i < kSize.num_pixels(); ++i)
      for (std::size_t c = 3; c < 9; ++c)
        norm += std::abs(static_cast<double>(g.features.data()[9 * i + c]));
    CHECK(norm > 0.1);
    for (std::size_t c = 0; c < 9; ++c) CHECK(g.features.data()[9 * 2 + c] == 0);  // not shaded
  }
}

TEST_CASE("Reflections from a map are the same for any number of threads and on a GPU") {
  const auto run = [] {
    Fixture f(3);
    std::map<std::string, std::vector<float>> results;
    const RasterOutputGradient g = f.gradient();
    results["outputs"] = read(f.field.forward(f.camera, f.surface, kWhere));
    results["features"] = read(g.features);
    results["normal"] = read(g.normal);
    results["map"] = read(f.field.map().gradient);
    results["network"] = read(f.field.network().parameters().gradient);
    return results;
  };
  check_same_as_cpu(1e-4, run);
  CHECK(with_threads(3, run) == with_threads(1, run));
}

TEST_CASE("Reflections come back from a file with the same bytes") {
  Fixture f(1), other(1);
  f.gradient();
  f.field.step(1);
  const TempFolder folder;
  f.field.save(folder.path(), 1);
  CHECK(other.field.load(folder.path(), 2) == 1);
  CHECK(
      other.field.forward(other.camera, other.surface, kWhere) ==
      f.field.forward(f.camera, f.surface, kWhere)
  );
  SpecularFieldConfig larger = small_config();
  larger.map_height = 16;
  SpecularField wrong(larger, {0, 0}, 1);
  CHECK_THROWS_WITH(wrong.load(folder.path(), 2), Catch::Contains("field.map"));
}

TEST_CASE("Weights that are not finite are refused with their file") {
  Fixture f(1);
  const TempFolder folder;
  f.field.save(folder.path(), 1);
  std::string bytes = read_file(folder / "specular_field.safetensors");
  const float nan = std::nanf("");
  std::memcpy(bytes.data() + bytes.size() - sizeof nan, &nan, sizeof nan);
  write_file(folder / "specular_field.safetensors", bytes);
  CHECK_THROWS_WITH(
      f.field.load(folder.path(), 2), Catch::Contains("specular_field.safetensors: field")
  );
}

TEST_CASE("A stage that the method does not have is an error that names file and stages") {
  Fixture f(1);
  const TempFolder folder;
  f.field.save(folder.path(), 3);
  CHECK_THROWS_WITH(
      f.field.load(folder.path(), 3),
      Catch::Contains("specular_field.safetensors") && Catch::Contains("'stage' is '3'") &&
          Catch::Contains("expected 0 to 2")
  );
}
