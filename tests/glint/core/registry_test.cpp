// SPDX-License-Identifier: MIT
#include "glint/core/registry.h"

#include <catch2/catch.hpp>

#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

struct Fruit {
  std::string id;
  int price = 0;
  std::string source = {};
};

struct Tool {
  std::string name;
};
const std::string& registry_id(const Tool& tool) { return tool.name; }

struct Shape {
  std::string id;
};

}  // namespace

GLINT_REGISTER(Fruit, {"pear", 2})
GLINT_REGISTER(Fruit, {"apple", 1})
GLINT_REGISTER(Tool, {"saw"})

TEST_CASE("what is registered is found in the order of its ids, with its file") {
  const auto& fruits = Registry<Fruit>::all();
  REQUIRE(fruits.size() == 2);
  CHECK(fruits.begin()->first == "apple");
  CHECK(fruits.at("pear").price == 2);
  CHECK(fruits.at("pear").source == "tests/glint/core/registry_test.cpp");
}

TEST_CASE("a kind may call its id otherwise") {
  CHECK(Registry<Tool>::all().at("saw").name == "saw");
}

TEST_CASE("an id that comes twice is an error that names both files") {
  CHECK(Registry<Shape>::add({"cube"}, "a.cpp"));
  CHECK(Registry<Shape>::all().size() == 1);
  CHECK_FALSE(Registry<Shape>::add({"cube"}, "b.cpp"));
  const std::string message =
      error_of(ExitCode::kEnvironment, [] { (void)Registry<Shape>::all(); });
  CHECK_THAT(message, Catch::Contains("'cube' is registered twice: in a.cpp and b.cpp"));
}
