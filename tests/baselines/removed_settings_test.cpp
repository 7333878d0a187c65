// SPDX-License-Identifier: MIT
// Settings of earlier run folders and profiles that methods no longer have.
#include "glint/removed_settings.h"

#include <catch2/catch.hpp>

#include "glint/method.h"

using namespace glint;
using Catch::Contains;

TEST_CASE("A setting that was taken out is accepted at the value that remains") {
  CHECK(
      create_method("glint", {{"only_seen", false}})->config() == create_method("glint")->config()
  );
  CHECK_NOTHROW(create_method("pgsr", {{"rate_exposure", 0.0010000000474974513}}));
  CHECK_NOTHROW(create_method("ref-gs", {{"random_background", true}}));
}

TEST_CASE("With another value it is an error that names setting, value and what to do") {
  CHECK_THROWS_WITH(
      create_method("glint/plus", {{"mirror_share_block", 4}}),
      Contains("glint/plus: mirror_share_block is 4") && Contains("it is 2") &&
          Contains("leave it out")
  );
  CHECK_THROWS_WITH(create_method("glint", {{"mirror_share_blocks", 2}}), Contains("no field"));
}

TEST_CASE("What a method does not offer has the value of its variant") {
  CHECK_NOTHROW(create_method("glint/text", {{"freeze_at_least", 10000}, {"min_surfels", 0}}));
  CHECK_THROWS_WITH(
      create_method("glint", {{"freeze_at_least", 10000}}),
      Contains("glint: freeze_at_least is 10000") && Contains("it is 0")
  );
  CHECK_NOTHROW(create_method("2dgs", {{"split_large", false}}));
  CHECK_NOTHROW(create_method("envgs", {{"split_large", false}}));  // is offered there
}
