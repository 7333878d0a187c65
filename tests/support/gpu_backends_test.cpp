// SPDX-License-Identifier: MIT
// Tests that need a GPU fail without one where there has to be one, and list what they find.
#include "tests/support/gpu_backends.h"

#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// Exit code of this program run again for the hidden test below.
int run_again(const std::string& environment) {
  const std::string self = fs::read_symlink("/proc/self/exe").string();
  return std::system((environment + " '" + self + "' 'same on every backend' >/dev/null").c_str());
}

}  // namespace

TEST_CASE("same on every backend", "[.]") {
  check_same_as_cpu(1e-6, [] {
    return std::map<std::string, std::vector<float>>{{"ones", {1, 1}}};
  });
}

TEST_CASE("A GPU that has to be there and is not is a failure") {
  CHECK(run_again("") == 0);
  CHECK(run_again("GLINT_REQUIRE_GPU=0") == 0);
  CHECK((run_again("GLINT_REQUIRE_GPU=1") == 0) == gpu::cuda_device().usable);
}

TEST_CASE("Differences are listed, those within their tolerance, too") {
  const TempFolder folder;
  const fs::path list = folder / "list";
  CHECK(run_again("GLINT_DIFFERENCES='" + list.string() + "'") == 0);
  CHECK_THAT(
      read_file(list),
      Catch::StartsWith("0.0e+00\t1.0e-06\tkernels on the host\tsame on every backend\tones\n")
  );
}
