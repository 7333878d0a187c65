// SPDX-License-Identifier: MIT
// The network against a plain loop in double, whose gradient is taken by central differences.
#include "baselines/deferred/mlp.h"

#include "tests/support/check_vjp.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/random_values.h"
#include "tests/support/temp_folder.h"
#include "tests/support/threads.h"

using namespace glint;
using namespace glint::test;

namespace {

// parameters: layer after layer, weights [in][out], biases [out].
Vector plain_outputs(const std::vector<int>& widths, const Vector& parameters, const Vector& x) {
  const auto in_width = static_cast<std::size_t>(widths.front());
  Vector outputs;
  for (std::size_t row = 0; row < x.size() / in_width; ++row) {
    Vector values(x.begin() + row * in_width, x.begin() + (row + 1) * in_width);
    std::size_t at = 0;
    for (std::size_t l = 0; l + 1 < widths.size(); ++l) {
      const auto in = static_cast<std::size_t>(widths[l]);
      const auto out = static_cast<std::size_t>(widths[l + 1]);
      Vector next(out);
      for (std::size_t o = 0; o < out; ++o) {
        next[o] = parameters[at + in * out + o];
        for (std::size_t k = 0; k < in; ++k) next[o] += values[k] * parameters[at + k * out + o];
        if (l + 2 < widths.size()) next[o] = std::max(next[o], 0.0);
      }
      at += (in + 1) * out;
      values = next;
    }
    outputs.insert(outputs.end(), values.begin(), values.end());
  }
  return outputs;
}

Vector in_double(std::span<const float> values) { return {values.begin(), values.end()}; }

void check_close(std::span<const float> actual, const Vector& expected, double relative) {
  REQUIRE(actual.size() == expected.size());
  const GradientError error = gradient_error<float>(actual, expected);
  REQUIRE(error.norm > 0);
  CHECK(error.distance < relative * error.norm);
}

struct Fixture {
  std::vector<int> widths;
  std::size_t rows;
  Mlp net{widths, 3};
  FloatArray x = random_array(rows * static_cast<std::size_t>(widths.front()), 1);
  FloatArray g = random_array(rows * static_cast<std::size_t>(widths.back()), 2);
  FloatArray dL_dx = FloatArray(x.size());

  Fixture(std::vector<int> w, std::size_t r) : widths(std::move(w)), rows(r) {}
  double plain_loss(const Vector& parameters, const Vector& inputs) const {
    const Vector y = plain_outputs(widths, parameters, inputs);
    double loss = 0;
    for (std::size_t i = 0; i < y.size(); ++i) loss += static_cast<double>(g[i]) * y[i];
    return loss;
  }
};

}  // namespace

TEST_CASE("A network gives what is computed by hand") {
  Mlp net({2, 2, 1}, 0);
  const float weights[] = {1, -1, 2, 3}, biases[] = {0.5f, -1}, last[] = {2, 10};
  std::copy_n(weights, 4, net.weights(0).begin());
  std::copy_n(biases, 2, net.biases(0).begin());
  std::copy_n(last, 2, net.weights(1).begin());
  net.biases(1)[0] = 0.25f;
  // (1, 1): hidden 1 + 2 + .5 = 3.5 and -1 + 3 - 1 = 1. (1, 0): 1.5, and -2, which is cut off.
  const FloatArray x = {1, 1, 1, 0};
  const FloatArray& y = net.forward(x);
  CHECK(y == FloatArray{2 * 3.5f + 10 + 0.25f, 2 * 1.5f + 0.25f});
  FloatArray dL_dx(4);
  net.backward(FloatArray{1, 1}, &dL_dx);
  CHECK(dL_dx == FloatArray{2 - 10, 4 + 30, 2, 4});
  // dL/dW of the first layer: x times (2, 10) where the hidden value is not cut off; biases alike.
  const FloatArray expected = {2 + 2, 10, 2, 10, 2 + 2, 10, 3.5f + 1.5f, 1, 2};
  CHECK(net.parameters().gradient == expected);
}

TEST_CASE("Outputs are those of a plain loop in double, for any number of rows") {
  for (const std::size_t rows : {1, 5, 256, 257, 900}) {
    INFO(rows);
    Fixture f({7, 16, 9, 3}, rows);
    const FloatArray& y = f.net.forward(f.x);
    check_close(
        y, plain_outputs(f.widths, in_double(f.net.parameters().values), in_double(f.x)), 1e-6
    );
  }
}

TEST_CASE("The gradients of a network match central differences of the plain loop") {
  // The second has more rows than one chunk of weight sums.
  for (const auto& [widths, rows] :
       {std::pair<std::vector<int>, std::size_t>{{5, 6, 4, 2}, 7}, {{2, 3, 1}, 256 * 64 + 300}}) {
    Fixture f(widths, rows);
    f.net.forward(f.x);
    f.net.backward(f.g, &f.dL_dx);
    const Vector p = in_double(f.net.parameters().values), x = in_double(f.x);
    const DifferenceStep small{1e-6, 1};  // few rows have a kink within it
    const Vector by_weights =
        central_differences([&](const Vector& moved) { return f.plain_loss(moved, x); }, p, small);
    check_close(f.net.parameters().gradient, by_weights, 2e-5);
    if (rows > 100) continue;  // inputs one by one
    const Vector by_inputs =
        central_differences([&](const Vector& moved) { return f.plain_loss(p, moved); }, x, small);
    check_close(f.dL_dx, by_inputs, 2e-6);
  }
}

TEST_CASE("Gradients of weights are added to, those of inputs may be left out") {
  Fixture f({3, 8, 2}, 40);
  f.net.forward(f.x);
  f.net.backward(f.g, &f.dL_dx);
  const FloatArray once = f.net.parameters().gradient;
  f.net.backward(f.g, nullptr);
  for (std::size_t i = 0; i < once.size(); ++i)
    CHECK(f.net.parameters().gradient[i] == 2 * once[i]);
}

TEST_CASE("A network gives the same bytes for any number of threads") {
  const auto run = [] {
    Fixture f({80, 64, 64, 3}, 3000);
    const FloatArray y = f.net.forward(f.x);
    f.net.backward(f.g, &f.dL_dx);
    f.net.parameters().step(1e-3f);
    return std::vector<FloatArray>{y, f.dL_dx, f.net.parameters().values};
  };
  const auto one = with_threads(1, run);
  CHECK(with_threads(2, run) == one);
  CHECK(with_threads(5, run) == one);
}

TEST_CASE("The kernels of a network give what the CPU's products give") {
  check_same_as_cpu(2e-5, [] {
    Fixture f({80, 64, 64, 3}, 700);
    std::map<std::string, std::vector<float>> results{{"outputs", read(f.net.forward(f.x))}};
    f.net.backward(f.g, &f.dL_dx);
    results["inputs"] = read(f.dL_dx);
    results["weights"] = read(f.net.parameters().gradient);
    return results;
  });
}

TEST_CASE("Weights start uniform in +-1/sqrt(fan in) and follow the seed") {
  Mlp net({100, 400, 3}, 5);
  double sum = 0, squares = 0;
  for (const float w : net.weights(0)) {
    CHECK(std::abs(w) <= 0.1f);
    sum += static_cast<double>(w);
    squares += square(static_cast<double>(w));
  }
  CHECK(std::abs(sum / 40000) < 4 * 0.1 / std::sqrt(3 * 40000.0));
  CHECK(squares / 40000 == Approx(0.01 / 3).epsilon(0.03));
  for (const float b : net.biases(1)) CHECK(std::abs(b) <= 0.05f);
  CHECK(Mlp({100, 400, 3}, 5).parameters().values == net.parameters().values);
  CHECK(Mlp({100, 400, 3}, 6).parameters().values != net.parameters().values);
}

TEST_CASE("A network learns a function that no linear one can give") {
  Mlp net({2, 16, 1}, 1);
  const FloatArray x = {0, 0, 0, 1, 1, 0, 1, 1}, target = {0, 1, 1, 0};
  double error = 0;
  for (int step = 0; step < 500; ++step) {
    const FloatArray y = net.forward(x);
    FloatArray g(4);
    error = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      g[i] = 2 * (y[i] - target[i]);
      error += square(static_cast<double>(y[i] - target[i]));
    }
    net.backward(g, nullptr);
    net.parameters().step(0.01f);
  }
  CHECK(error < 1e-3);
}

TEST_CASE("A network comes back from a file with the same bytes, and other widths are refused") {
  const TempFolder folder;
  const fs::path file = folder.path() / "net.safetensors";
  const Mlp net({4, 5, 2}, 9);
  write_safetensors(file, {}, net.tensors("mlp"));
  SafetensorsFile in(file);
  Mlp same({4, 5, 2}, 1), other({4, 6, 2}, 1);
  same.read(in, "mlp");
  CHECK(same.parameters().values == net.parameters().values);
  CHECK_THROWS_WITH(other.read(in, "mlp"), Catch::Contains("mlp.0.weight"));
}

TEST_CASE("No rows are no work, and rows that do not fit are refused") {
  Mlp net({3, 2}, 0);
  CHECK(net.forward({}).empty());
  net.backward({}, nullptr);
  for (const float g : net.parameters().gradient) CHECK(g == 0);
  CHECK_THROWS_WITH(net.forward(FloatArray(4)), Catch::Contains("4 inputs are no rows of 3"));
  net.forward(FloatArray(6));
  CHECK_THROWS_WITH(
      net.backward(FloatArray(3), nullptr), Catch::Contains("gradients of 3 outputs")
  );
  CHECK_THROWS_WITH(Mlp({3}, 0), Catch::Contains("widths"));
  CHECK_THROWS_WITH(Mlp({3, 0, 1}, 0), Catch::Contains("widths"));
}

TEST_CASE("A value that is not finite is named") {
  Mlp net({2, 1}, 0);
  CHECK_NOTHROW(net.parameters().check_finite("network"));
  net.biases(0)[0] = std::nanf("");
  CHECK_THROWS_WITH(
      net.parameters().check_finite("network"), Catch::Contains("network: value 2 of 3")
  );
}
