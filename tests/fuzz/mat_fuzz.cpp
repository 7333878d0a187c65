// SPDX-License-Identifier: MIT
// MAT files of ClearPose's scenes.
#include "datasets/mat_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/mat_bytes.h"

namespace glint::fuzz {
namespace {

bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "metadata.mat");
  return accepts([&] { read_mat(file); });
}

std::vector<FuzzInput> seeds() {
  const std::string frame = test::mat_struct(
      "000000",
      {{"intrinsic_matrix", test::mat_array("", 2, 2, {1, 0, 0, 1})},
       {"factor_depth", test::mat_array("", 1, 1, {1000})},
       {"none", test::mat_array("", 0, 0, {})}}
  );
  return {
      {"struct", test::mat_file({frame})},
      {"compressed", test::mat_file({test::mat_compressed(frame)})},
      {"two", test::mat_file({test::mat_array("a", 1, 3, {1, 2, 3}), frame})}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"mat", read, seeds})

}  // namespace glint::fuzz
