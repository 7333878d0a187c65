// SPDX-License-Identifier: MIT
// One check for every formula and its _vjp: random output gradients against central differences.
#pragma once

#include <catch2/catch.hpp>

#include <functional>

#include "glint/core/rng.h"
#include "glint/core/vec.h"
#include "tests/support/gradcheck.h"

namespace glint::test {

using Vector = std::vector<double>;

// f: inputs -> outputs; vjp: (inputs, output gradient) -> input gradient. `relative` bounds the
// distance of the gradients over the norm; formulas in double reach 1e-8.
inline void check_vjp(
    const Vector& inputs,
    const std::function<Vector(const Vector&)>& f,
    const std::function<Vector(const Vector&, const Vector&)>& vjp,
    double relative = 1e-7
) {
  Rng rng(7, inputs.size());
  Vector g(f(inputs).size());
  for (double& value : g) value = static_cast<double>(rng.uniform(-1, 1));
  const auto loss = [&](const Vector& x) {
    const Vector y = f(x);
    double sum = 0;
    for (std::size_t i = 0; i < y.size(); ++i) sum += g[i] * y[i];
    return sum;
  };
  const Vector expected = central_differences(loss, inputs);
  const Vector actual = vjp(inputs, g);
  REQUIRE(actual.size() == expected.size());
  const GradientError error = gradient_error<double>(actual, expected);
  INFO("largest difference at input " << error.worst_index);
  REQUIRE(error.norm > 0);
  CHECK(error.distance <= relative * error.norm);
}

// Random inputs in [low, high].
inline Vector random_inputs(std::size_t count, double low, double high, std::uint64_t seed) {
  Rng rng(seed);
  Vector x(count);
  for (double& value : x) value = low + (high - low) * static_cast<double>(rng.uniform());
  return x;
}

inline Vec3d vec3(const Vector& x, std::size_t i) { return {x[i], x[i + 1], x[i + 2]}; }
inline void push(Vector& x, Vec3d v) { x.insert(x.end(), {v.x, v.y, v.z}); }

}  // namespace glint::test
