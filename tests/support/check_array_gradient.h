// SPDX-License-Identifier: MIT
// Gradients of sets of surfels against central differences of a loss in float.
#pragma once

#include <catch2/catch.hpp>
#include <string>

#include "glint/core/rng.h"
#include "glint/train/trainable_set.h"
#include "tests/support/gradcheck.h"

namespace glint::test {

// Of a few parameters of an array (of its first `among`; 0: of all), whose gradient by loss() the
// set holds.
template <class Loss>
void check_array_gradient(
    Loss&& loss,
    TrainableSet& set,
    FloatArray SurfelCloud::*array,
    const std::string& name,
    std::size_t among = 0
) {
  FloatArray& values = set.cloud().*array;
  if (among == 0) among = values.size();
  std::vector<double> expected;
  std::vector<float> actual;
  Rng rng(5);
  for (int k = 0; k < 40; ++k) {
    const std::size_t i = rng.below(static_cast<std::uint32_t>(among));
    const float at = values[i], h = 0.02f;
    values[i] = at + h;
    const double above = loss();
    values[i] = at - h;
    const double below = loss();
    values[i] = at;
    expected.push_back((above - below) / (2 * static_cast<double>(h)));
    actual.push_back((set.gradient().*array)[i]);
  }
  const GradientError error = gradient_error<float>(actual, expected);
  INFO(
      name << ", norm " << error.norm << ", distance " << error.distance << ", worst at "
           << error.worst_index
  );
  CHECK(error.norm > 0);
  CHECK(error.distance < 1e-2 * error.norm);
}

}  // namespace glint::test
