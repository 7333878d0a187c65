// SPDX-License-Identifier: MIT
// Appearance from lobes: its formulas by central differences, the whole against a plain loop in
// double.
#include "baselines/planar/lobe_appearance.h"

#include <numbers>

#include "tests/support/check_vjp.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/random_values.h"
#include "tests/support/temp_folder.h"
#include "tests/support/threads.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr LobeAppearanceConfig kSmall{.feature = 5, .theta = 3, .phi = 4, .hidden = 6, .rates = {}};

constexpr std::size_t kSurfels = 9;

struct Fixture {
  LobeAppearance appearance;
  FloatArray means = random_array(3 * kSurfels, 2);
  Array<std::uint8_t> visible = {1, 0, 1, 1, 0, 0, 1, 1, 0};
  FloatArray g = random_array(3 * kSurfels, 4);
  Vec3f eye{0.2f, -3, 0.5f};

  explicit Fixture(const LobeAppearanceConfig& config) : appearance(config, kSurfels, 1) {
    appearance.features().values = random_array(appearance.features().size(), 5);
  }
  const FloatArray& forward() { return appearance.forward(means, eye, visible); }
};

Vector linear(const Vector& x, const Mlp& net, std::size_t layer, const Vector& p, bool relu) {
  std::size_t at = 0;
  for (std::size_t l = 0; l < layer; ++l)
    at += static_cast<std::size_t>((net.widths()[l] + 1) * net.widths()[l + 1]);
  const auto out = static_cast<std::size_t>(net.widths()[layer + 1]);
  Vector y(out);
  for (std::size_t o = 0; o < out; ++o) {
    y[o] = p[at + x.size() * out + o];
    for (std::size_t k = 0; k < x.size(); ++k) y[o] += x[k] * p[at + k * out + o];
    if (relu) y[o] = std::max(y[o], 0.0);
  }
  return y;
}

// The text of the publication in double; `p` are features, then both networks' parameters.
double plain_loss(Fixture& f, const Vector& p) {
  const LobeAppearanceConfig& c = f.appearance.config();
  const auto width = static_cast<std::size_t>(c.feature);
  const auto first = p.begin() + static_cast<std::ptrdiff_t>(f.appearance.features().size());
  const auto second =
      first + static_cast<std::ptrdiff_t>(f.appearance.to_lobes().parameters().size());
  const Vector to_lobes(first, second), to_color(second, p.end());
  double loss = 0;
  for (std::size_t i = 0; i < kSurfels; ++i) {
    if (f.visible[i] == 0) continue;
    const Vector feature(p.begin() + i * width, p.begin() + (i + 1) * width);
    const Vector numbers = linear(feature, f.appearance.to_lobes(), 0, to_lobes, false);
    const Vec3d view = normalize(cast<double>(get3(f.means.data(), i) - f.eye));
    Vector inputs;
    for (int t = 0; t < c.theta; ++t)
      for (int q = 0; q < c.phi; ++q) {
        const double theta = std::numbers::pi * t / (c.theta - 1);
        const double phi = 2 * std::numbers::pi * q / (c.phi - 1);
        const Vec3d axis{
            std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
        const Vec3d a{
            std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi), -std::sin(theta)};
        const Vec3d b = cross(axis, a);
        const double* x = numbers.data() + 4 * (t * c.phi + q);
        const double sharpness = std::log1p(std::exp(x[2] - 1)) * std::pow(dot(a, view), 2) +
                                 std::log1p(std::exp(x[3] - 1)) * std::pow(dot(b, view), 2);
        const double strength = std::max(dot(axis, view), 0.0) * std::exp(-sharpness);
        inputs.insert(inputs.end(), {x[0] * strength, x[1] * strength});
      }
    push(inputs, view);
    for (const double octave : {1.0, 2.0}) {
      for (int axis = 0; axis < 3; ++axis) inputs.push_back(std::sin(octave * view[axis]));
      for (int axis = 0; axis < 3; ++axis) inputs.push_back(std::cos(octave * view[axis]));
    }
    Vector y = inputs;
    for (std::size_t l = 0; l < 3; ++l) y = linear(y, f.appearance.to_color(), l, to_color, l < 2);
    for (std::size_t k = 0; k < 3; ++k) loss += static_cast<double>(f.g[3 * i + k]) * y[k];
  }
  return loss;
}

Vector all_parameters(LobeAppearance& a) {
  Vector p(a.features().values.begin(), a.features().values.end());
  for (const Mlp* net : {&a.to_lobes(), &a.to_color()})
    p.insert(p.end(), net->parameters().values.begin(), net->parameters().values.end());
  return p;
}

}  // namespace

TEST_CASE("A lobe's gradient matches central differences") {
  const auto frame = lobe_frame(std::sin(0.7), std::cos(0.7), std::sin(2.1), std::cos(2.1));
  const Vec3d r = normalize(frame.axis + 0.4 * frame.tangent_phi - 0.3 * frame.tangent_theta);
  check_vjp(
      random_inputs(4, -2, 2, 1),
      [&](const Vector& x) {
        const Vec2d value = lobe(frame, x.data(), r);
        return Vector{value.x, value.y};
      },
      [&](const Vector& x, const Vector& g) {
        Vector dL_dx(4);
        lobe_vjp(frame, x.data(), r, {g[0], g[1]}, dL_dx.data());
        return dL_dx;
      }
  );
}

TEST_CASE("A lobe is its amplitude along its axis, and nothing behind it") {
  const auto frame = lobe_frame(std::sin(0.7), std::cos(0.7), std::sin(2.1), std::cos(2.1));
  const double numbers[] = {2, -3, 0.5, 4};
  CHECK(lobe(frame, numbers, frame.axis).x == Approx(2));
  CHECK(lobe(frame, numbers, frame.axis).y == Approx(-3));
  CHECK(lobe(frame, numbers, -frame.axis).x == 0);
  // Sharper across the second tangent, whose number is larger.
  const Vec3d a = normalize(frame.axis + frame.tangent_theta);
  const Vec3d b = normalize(frame.axis + frame.tangent_phi);
  CHECK(lobe(frame, numbers, a).x > lobe(frame, numbers, b).x);
  CHECK(softplus(0.0) == Approx(std::log(2)));
  CHECK(softplus(80.0) == Approx(80));
  CHECK(softplus(-40.0f) == Approx(std::exp(-40.0)).margin(1e-7));
}

TEST_CASE("Frames are orthonormal and span the sphere's grid") {
  for (const double theta : {0.0, 0.4, 2.0, 3.1})
    for (const double phi : {0.0, 1.0, 5.0}) {
      const auto f = lobe_frame(std::sin(theta), std::cos(theta), std::sin(phi), std::cos(phi));
      CHECK(length(f.axis) == Approx(1));
      CHECK(length(f.tangent_theta) == Approx(1));
      CHECK(dot(f.axis, f.tangent_theta) == Approx(0).margin(1e-12));
      CHECK(length(cross(f.axis, f.tangent_theta) - f.tangent_phi) < 1e-12);
    }
}

TEST_CASE("Sizes are the published ones") {
  const LobeAppearanceConfig config;
  CHECK(config.input_width() == 2 * 8 + 3 + 12);
  CHECK(LobeAppearance(config, 3, 0).to_lobes().widths() == std::vector<int>{12, 32});
  CHECK(LobeAppearance(config, 3, 0).to_color().widths() == std::vector<int>{31, 32, 32, 3});
}

TEST_CASE("Offsets and gradients are those of the publication's text in double") {
  Fixture f(kSmall);
  const FloatArray offsets = f.forward();
  const Vector p = all_parameters(f.appearance);
  double loss = 0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    loss += static_cast<double>(f.g[i]) * static_cast<double>(offsets[i]);
    if (f.visible[i / 3] == 0) CHECK(offsets[i] == 0);
  }
  CHECK(loss == Approx(plain_loss(f, p)).epsilon(1e-5));
  f.appearance.backward(f.g);
  const Vector expected =
      central_differences([&](const Vector& x) { return plain_loss(f, x); }, p, {1e-5, 1});
  Vector actual(f.appearance.features().gradient.begin(), f.appearance.features().gradient.end());
  for (const Mlp* net : {&f.appearance.to_lobes(), &f.appearance.to_color()})
    actual.insert(
        actual.end(), net->parameters().gradient.begin(), net->parameters().gradient.end()
    );
  const GradientError error = gradient_error<double>(actual, expected);
  INFO("worst at " << error.worst_index);
  REQUIRE(error.norm > 0);
  CHECK(error.distance < 1e-5 * error.norm);
}

TEST_CASE("Appearance from lobes is the same for any number of threads and on a GPU") {
  const auto run = [] {
    const std::size_t count = 2000;
    LobeAppearance a({}, count, 3);
    a.features().values = random_array(a.features().size(), 1);
    const FloatArray means = random_array(3 * count, 2), g = random_array(3 * count, 4);
    Array<std::uint8_t> visible(count);
    for (std::size_t i = 0; i < count; ++i) visible[i] = i % 3 != 0;
    std::map<std::string, std::vector<float>> results;
    results["offsets"] = read(a.forward(means, {0, 0, -4}, visible));
    a.backward(g);
    results["features"] = read(a.features().gradient);
    results["to_lobes"] = read(a.to_lobes().parameters().gradient);
    results["to_color"] = read(a.to_color().parameters().gradient);
    return results;
  };
  check_same_as_cpu(5e-5, run);
  CHECK(with_threads(3, run) == with_threads(1, run));
}

TEST_CASE("Appearance from lobes learns, and comes back from a file") {
  Fixture f{LobeAppearanceConfig{}};
  f.appearance.features() = TrainableArray(f.appearance.features().size());  // as it starts
  double first = 0, last = 0;
  for (int step = 0; step < 300; ++step) {
    const FloatArray y = f.forward();
    FloatArray g(y.size());
    last = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      if (f.visible[i / 3] == 0) continue;
      g[i] = y[i] - f.g[i];
      last += square(static_cast<double>(g[i]));
    }
    if (step == 0) first = last;
    f.appearance.backward(g);
    f.appearance.step(step, 300);
  }
  CHECK(last < 0.2 * first);
  CHECK_NOTHROW(f.appearance.check_finite("appearance"));
  const TempFolder folder;
  const fs::path file = folder.path() / "appearance.safetensors";
  write_safetensors(file, {}, f.appearance.tensors("appearance"));
  const FloatArray expected = f.forward();
  Fixture other{LobeAppearanceConfig{}};
  SafetensorsFile in(file);
  other.appearance.read(in, "appearance");
  CHECK(other.forward() == expected);
}

TEST_CASE("Surfels that reach a pixel are among those in the pyramid, most others are not") {
  SurfelCloud cloud;
  const std::size_t count = 4000;
  cloud.resize(count);
  cloud.means = random_array(3 * count, 1, -4, 4);
  cloud.log_scales = random_array(2 * count, 2, -7, 0);
  cloud.rotations = random_array(4 * count, 3);
  cloud.opacity_logits = random_array(count, 4, -6, -3);
  SurfelSet set(cloud);
  std::size_t marked = 0, reached = 0;
  for (const Vec3d eye : {Vec3d{0, 0, 0}, Vec3d{3, 1, -2}, Vec3d{0, -6, 1}}) {
    const Camera camera = look_at(eye, {0.3, 0.5, 0.2}, {0, 0, 1}, {64, 36}, 60);
    const RasterOutput& output = set.forward(camera, 0);
    Array<std::uint8_t> visible;
    mark_in_pyramid(cloud, camera, visible);
    REQUIRE(visible.size() == count);
    std::size_t missed = 0;
    for (std::size_t i = 0; i < count; ++i) {
      missed += output.visibility[i] > 0 && visible[i] == 0 ? 1 : 0;
      reached += output.visibility[i] > 0 ? 1 : 0;
      marked += visible[i];
    }
    CHECK(missed == 0);
  }
  INFO(reached << " reach a pixel, " << marked << " are in the pyramid");
  CHECK(reached > 500);
  CHECK(marked < 3 * count / 2);
}

TEST_CASE("A cloud and a camera give what their arrays give, there and back") {
  Fixture f(kSmall);
  SurfelCloud cloud;
  cloud.resize(kSurfels);
  cloud.means = f.means;
  cloud.log_scales = FloatArray(2 * kSurfels, -2.0f);
  cloud.rotations = random_array(4 * kSurfels, 8);
  const Camera camera = look_at({0.2, -3, 0.5}, {0, 0, 0}, {0, 0, 1}, {64, 36}, 30);
  const FloatArray offsets = f.appearance.forward(cloud, camera);
  RasterGradient gradient;
  gradient.features = random_array(4 * kSurfels, 9);
  f.appearance.backward(gradient, 4);
  const FloatArray dL_dfeatures = f.appearance.features().gradient;

  Fixture plain(kSmall);
  mark_in_pyramid(cloud, camera, plain.visible);
  plain.eye = cast<float>(camera.center());
  CHECK(offsets == plain.forward());
  CHECK(std::count(plain.visible.begin(), plain.visible.end(), 1) > 0);
  for (std::size_t i = 0; i < kSurfels; ++i)
    std::copy_n(&gradient.features[4 * i], 3, &plain.g[3 * i]);
  plain.appearance.backward(plain.g);
  CHECK(dL_dfeatures == plain.appearance.features().gradient);
}

TEST_CASE("Arrays of another number of surfels are refused") {
  Fixture f(kSmall);
  CHECK_THROWS_WITH(f.appearance.backward(f.g), Catch::Contains("the last forward() gave 0"));
  f.means.resize(6);
  CHECK_THROWS_WITH(f.forward(), Catch::Contains("made for 9 surfels, found 2 means"));
}
