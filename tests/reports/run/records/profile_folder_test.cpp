// SPDX-License-Identifier: MIT
#include "reports/run/records/profile_folder.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

void write_record(const fs::path& folder, const std::string& profile) {
  write_file(
      folder / "records.jsonl",
      fmt::format(R"({{"scene": "s", "method": "m", "profile": "{}"}})", profile) + "\n"
  );
}

}  // namespace

TEST_CASE("a profile's folder is OUT/PROFILE, or OUT with records of its own") {
  const test::TempFolder out;
  CHECK(profile_folder(out.path(), "ci") == out / "ci");
  write_record(out.path(), "ci");
  CHECK(profile_folder(out.path(), "ci") == out.path());
  CHECK(own_profile_folder(out.path(), "ci") == out.path());
  CHECK_THROWS_WITH(
      own_profile_folder(out.path(), "small"), Catch::Contains("holds the records of profile ci")
  );
  write_record(out / "small", "small");
  CHECK(own_profile_folder(out.path(), "small") == out / "small");
}

TEST_CASE("a folder without records says what to run and where there are some") {
  const test::TempFolder out;
  CHECK_THROWS_WITH(
      folder_with_records(out / "ci", "ci"),
      Catch::Contains("`glint-bench all --profile ci --out " + out.path().string() + "`")
  );
  write_record(out / "smoke", "smoke");
  CHECK_THROWS_WITH(folder_with_records(out.path(), "ci"), Catch::Contains("has records of smoke"));
  CHECK(folder_with_records(out.path(), "smoke") == out / "smoke");
  write_file(out / "ci/records.jsonl", "");
  CHECK_THROWS_AS(folder_with_records(out.path(), "ci"), Error);
}

TEST_CASE("what to give is named by a profile that there is, or by its file") {
  const test::TempFolder out;
  const auto refusal = [&](const std::string& profile) {
    write_record(out.path(), profile);
    return test::error_of(ExitCode::kUsage, [&] { own_profile_folder(out.path(), "small"); });
  };
  CHECK_THAT(refusal("ci"), Catch::Contains("give --profile ci, or another --out for profile"));
  fs::remove(out / "records.jsonl");
  CHECK_THAT(refusal("single"), Catch::Contains("of single runs; give another --out for profile"));
  fs::remove(out / "records.jsonl");
  CHECK_THAT(refusal("tiny"), Catch::Contains("of profile tiny; give --profile with its file, or"));
  fs::remove(out / "records.jsonl");
  CHECK_THROWS_WITH(
      folder_with_records(out.path(), "cfg/tiny.toml"),
      Catch::Contains("/tiny: no records.jsonl; run `glint-bench all --profile cfg/tiny.toml --out")
  );
}
