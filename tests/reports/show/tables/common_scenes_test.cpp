// SPDX-License-Identifier: MIT
#include "reports/show/tables/common_scenes.h"

#include <catch2/catch.hpp>

using namespace glint;

namespace {

SizedScenes scenes(const std::vector<std::string>& names, const std::string& size = "160x90") {
  SizedScenes result;
  for (const std::string& name : names) result.insert({name, size});
  return result;
}

}  // namespace

TEST_CASE("common scenes are those on which most values can be compared") {
  using ByMethod = std::map<std::string, SizedScenes>;
  CHECK(common_scenes(ByMethod{}).empty());
  CHECK(common_scenes({{"a", scenes({"1", "2"})}}) == scenes({"1", "2"}));
  // One import of one scene, or of another size, takes nothing from the others.
  ByMethod methods = {{"a", scenes({"1", "2"})}, {"b", scenes({"1", "2"})}};
  for (const SizedScenes& import : {scenes({"1"}), scenes({"9"}), scenes({"1", "2"}, "120x68")}) {
    methods["import"] = import;
    CHECK(common_scenes(methods) == scenes({"1", "2"}));
  }
  // Two methods share two of three scenes.
  CHECK(
      common_scenes({{"a", scenes({"1", "2", "3"})}, {"b", scenes({"2", "3", "4"})}}) ==
      scenes({"2", "3"})
  );
  // Early in a run most methods have the first scene only.
  methods = {{"a", scenes({"1", "2"})}};
  for (const char* method : {"b", "c", "d", "e"}) methods[method] = scenes({"1"});
  CHECK(common_scenes(methods) == scenes({"1"}));
}

TEST_CASE("failed cells bring no scenes") {
  std::vector<Record> records(2);
  records[0].cell = {"1", "a", 0};
  records[1].cell = {"2", "a", 0};
  records[1].failure.emplace();
  CHECK(common_scenes(records).at("").size() == 1);
}
