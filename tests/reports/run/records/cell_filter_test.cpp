// SPDX-License-Identifier: MIT
#include "reports/run/records/cell_filter.h"

#include <catch2/catch.hpp>

#include "tests/reports/fake_method.h"

using namespace glint;

namespace {

std::vector<Record> records_of(const std::vector<std::string>& methods) {
  std::vector<Record> records;
  for (const std::string& method : methods) {
    records.emplace_back();
    records.back().cell = {"room_1", method, 0};
  }
  return records;
}

}  // namespace

TEST_CASE("methods are chosen by globs of their ids, cells by the other globs, too") {
  const CellKey cell{"room_1", "glint/no-refl", 3};
  CHECK(filter_accepts({}, cell));
  CHECK(filter_accepts({{}, {}, {"glint/*"}}, cell));
  CHECK(filter_accepts({{"room_1"}, {}, {"2dgs", "glint/no-refl"}}, cell));
  CHECK_FALSE(filter_accepts({{}, {}, {"glint"}}, cell));
  CHECK_FALSE(filter_accepts({{"room_2"}, {}, {"glint/*"}}, cell));
  CHECK_FALSE(filter_accepts({{}, {"*/3"}, {"glint/*"}}, cell));
}

TEST_CASE("a profile's methods are chosen among its own first, then among the program's") {
  register_fake_methods();
  using Ids = std::vector<std::string>;
  CHECK(planned_methods({"fake"}, {}) == Ids{"fake"});
  CHECK(planned_methods({"fake"}, {"fake*"}) == Ids{"fake"});
  CHECK(planned_methods({"fake"}, {"fake/other"}) == Ids{"fake/other"});
  CHECK(planned_methods({}, {"fake", "fake*"}) == Ids{"fake", "fake/other"});
  CHECK_THROWS_WITH(planned_methods({"fake"}, {"none"}), Catch::Contains("none"));
}

TEST_CASE("records are chosen, and a choice of nothing says what there is") {
  const auto records = records_of({"a", "b", "a/prior"});
  CHECK(chosen_records(records, {}).size() == 3);
  CHECK(chosen_records(records, {{}, {}, {"a*"}}).size() == 2);
  CHECK(chosen_records(records, {{"b"}, {}, {}}).front().cell.method == "b");
  CHECK_THROWS_WITH(
      chosen_records(records, {{}, {}, {"c"}}),
      Catch::Contains("--methods c") && Catch::Contains("a, a/prior, b")
  );
  CHECK_THROWS_WITH(
      chosen_records(records, {{"room_2"}, {}, {}}), Catch::Contains("none of 3 cells")
  );
  CHECK(chosen_records({}, {}).empty());
}
