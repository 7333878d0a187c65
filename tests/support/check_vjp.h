// SPDX-License-Identifier: MIT
// One check for every formula and its _vjp: random output gradients against central differences.
#pragma once

#include <catch2/catch.hpp>

#include <cstring>
#include <functional>
#include <tuple>

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

// The doubles that values consist of, one after another, and such values of doubles.
template <class... T>
Vector numbers(const T&... values) {
  static_assert(((sizeof(T) % sizeof(double) == 0 && std::is_trivially_copyable_v<T>)&&...));
  Vector x;
  const auto append = [&x](const auto& value) {
    const auto* first = reinterpret_cast<const double*>(&value);
    x.insert(x.end(), first, first + sizeof value / sizeof(double));
  };
  (append(values), ...);
  return x;
}
template <class... T>
std::tuple<T...> values_of(const Vector& x) {
  const double* at = x.data();
  const auto next = [&at](auto value) {
    std::memcpy(static_cast<void*>(&value), at, sizeof value);
    at += sizeof value / sizeof(double);
    return value;
  };
  return std::tuple<T...>{next(T{})...};
}

// The same of formulas as they stand: f(in...), and vjp(in..., dL_df, dL_din&...), which adds, or
// vjp(in..., dL_df), which returns dL_din.
template <class F, class Vjp, class... In>
void check_formula(F f, Vjp vjp, const In&... at) {
  using Out = std::invoke_result_t<F, In...>;
  const auto outputs = [&](const Vector& x) { return numbers(std::apply(f, values_of<In...>(x))); };
  check_vjp(numbers(at...), outputs, [&](const Vector& x, const Vector& g) {
    const auto given = std::tuple_cat(values_of<In...>(x), values_of<Out>(g));
    if constexpr (std::is_invocable_v<Vjp, In..., Out>) {
      return numbers(std::apply(vjp, given));
    } else {
      std::tuple<In...> sum{};
      const auto sums = std::apply([](In&... parts) { return std::tie(parts...); }, sum);
      std::apply(vjp, std::tuple_cat(given, sums));
      return std::apply([](const In&... parts) { return numbers(parts...); }, sum);
    }
  });
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
