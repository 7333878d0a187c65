// SPDX-License-Identifier: MIT
#include "glint/core/rows.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"

namespace glint {

TEST_CASE("a row's values are fields of an object and words in columns") {
  Rows rows({{"name", "name"}, {"bytes", "size", "{:.1f} MB"}, {"", "why"}}, "used");
  rows.add({"a", {2500000, "2.5 MB"}, "it is old", true});
  rows.add({"longer", 12.0, "", Cell::absent()});
  CHECK(rows.json() == Json::parse(R"([{"name": "a", "bytes": 2500000, "used": true},
                                     {"name": "longer", "bytes": 12.0}])"));
  CHECK(rows.text() == "name       size  why\na        2.5 MB  it is old\nlonger  12.0 MB\n");
  CHECK_THROWS_AS(rows.add({"too few"}), Error);
}

TEST_CASE("rows without headings have no line of them, and null is a dash") {
  Rows rows({{"first"}, {"second", "", "{}"}});
  CHECK(rows.text().empty());
  rows.add({Json(), 3});
  rows.add({"±", 0.25});
  CHECK(rows.text() == "-     3\n±  0.25\n");
}

TEST_CASE("a last cell of words that is too long goes on below itself") {
  const std::vector<std::vector<std::string>> rows = {{"a", "one two three four five six seven"}};
  CHECK(aligned_rows(rows, 30) == "a  one two three four five six\n   seven\n");
  CHECK(aligned_rows(rows, 20) == "a  one two three four five six seven\n");  // no room
}

}  // namespace glint
