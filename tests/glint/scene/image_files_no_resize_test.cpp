// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "glint/scene/image_files.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("a program without glint_resize says which build can") {
  const Image image(4, 4, 1);
  CHECK_THAT(
      error_of(
          ExitCode::kEnvironment,
          [&] {
            resize_image(image, {2, 2});
          }
      ),
      Catch::Contains("dataset pack --max-pixels")
  );
}
