// SPDX-License-Identifier: MIT
#include "glint/core/service.h"

#include <catch2/catch.hpp>

#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

constinit Service<int(int, int&)> added{"adding", "count on your fingers"};
constinit Service<void()> absent{"flying", "take the stairs"};

int add(int a, int& sum) { return sum += a; }

}  // namespace

GLINT_PROVIDE(added, add)

TEST_CASE("a service that a library brings is called like a function") {
  int sum = 3;
  CHECK(added.here());
  CHECK(added(4, sum) == 7);
  CHECK(sum == 7);
}

TEST_CASE("a service that none brings says what to do instead") {
  CHECK_FALSE(absent.here());
  const std::string message = error_of(ExitCode::kEnvironment, [] { absent(); });
  CHECK_THAT(message, Catch::Contains("flying") && Catch::Contains("take the stairs"));
}

TEST_CASE("a service is brought once") {
  error_of(ExitCode::kEnvironment, [] { added.provide(&add); });
}
