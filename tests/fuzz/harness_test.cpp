// SPDX-License-Identifier: MIT
// The harness finds what it is there to find.
#include <catch2/catch.hpp>

#include "tests/fuzz/fuzz_target.h"

using namespace glint;
using namespace glint::fuzz;
using Catch::Contains;

namespace {

template <class F>
std::string finding(F) {
  const FuzzTarget target{"made", [](std::string_view) { return accepts(F{}); }, nullptr};
  return outcome_of(target, "bytes").finding;
}

void fail_with(const std::string& message) { throw Error(ExitCode::kBadReference, message); }

}  // namespace

TEST_CASE("an error that names its file is no finding, anything else is one") {
  CHECK(finding([] {}).empty());
  CHECK(finding([] { fail_with(input_file("x", "input").string() + ": bad"); }).empty());
  CHECK_THAT(finding([] { fail_with("it is bad"); }), Contains("does not name the file"));
  CHECK_THAT(
      finding([] { fail_with(input_folder().string() + std::string(1 << 20, 'x')); }),
      Contains("a message of")
  );
  CHECK_THAT(finding([] { throw std::out_of_range("at"); }), Contains("out_of_range"));
  CHECK_THAT(finding([] { throw OutOfMemory("much"); }), Contains("much"));
  CHECK_THAT(
      finding([] { std::vector<char>(std::size_t{3} << 30, 'x')[5] = 'y'; }), Contains("MiB")
  );
}

TEST_CASE("damaged copies are cut off and changed, the same ones every time") {
  const std::string bytes = "sixteen bytes !!";
  const std::vector<std::string> all = damaged(bytes);
  CHECK(all == damaged(bytes));
  CHECK(all.front().empty());
  CHECK(all[15] == bytes.substr(0, 15));
  CHECK(std::count(all.begin(), all.end(), bytes) < 4);
  CHECK(damaged("").size() == 16);
}
