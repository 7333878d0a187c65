// SPDX-License-Identifier: MIT
#include "glint/core/nearest.h"

#include <catch2/catch.hpp>

using namespace glint;

TEST_CASE("edits are counted, a swap as one") {
  CHECK(edit_distance("", "") == 0);
  CHECK(edit_distance("render", "render") == 0);
  CHECK(edit_distance("", "abc") == 3);
  CHECK(edit_distance("abc", "") == 3);
  CHECK(edit_distance("redner", "render") == 1);
  CHECK(edit_distance("rendr", "render") == 1);
  CHECK(edit_distance("kitten", "sitting") == 3);
  CHECK(edit_distance("ab", "ba") == 1);
}

TEST_CASE("the nearest word is found, and none where none is near") {
  const std::vector<std::string> verbs = {"all", "eval", "render", "report", "table", "train"};
  CHECK(nearest_word("redner", verbs) == "render");
  CHECK(nearest_word("tabel", verbs) == "table");
  CHECK(nearest_word("TRAIN", verbs) == "train");
  CHECK(nearest_word("evaluate", verbs).empty());
  CHECK(nearest_word("fly", verbs).empty());
  CHECK(nearest_word("", verbs).empty());
  CHECK(nearest_word("x", {"y"}).empty());
  CHECK(nearest_word("iter", {"out", "seed", "iterations"}) == "iterations");
  CHECK(nearest_word("anything", {}).empty());
}

TEST_CASE("messages name it") {
  CHECK(did_you_mean("glitn", {"2dgs", "glint"}) == "did you mean 'glint'? ");
  CHECK(did_you_mean("nerf", {"2dgs", "glint"}).empty());
  CHECK(comma_list({"a", "b"}) == "a, b");
  CHECK(comma_list({}).empty());
}
