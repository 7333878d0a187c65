// SPDX-License-Identifier: MIT
#include "reports/show/pictures/growth_log.h"

#include <catch2/catch.hpp>

#include "glint/core/config.h"
#include "tests/support/temp_folder.h"

using namespace glint;

TEST_CASE("a log's surfels keep their last count, PSNR is averaged, test views stand where they are"
) {
  const test::TempFolder folder;
  std::string text;
  for (int i = 9; i < 4000; i += 10) {  // 400 lines
    Json line = {{"iteration", i}, {"num_surfels", i}, {"psnr", (i / 10) % 2 ? 20 : 30}};
    if (i >= 2000) line["sets"] = {{"interface", i}, {"reflection", 1}};
    if (i == 1999 || i == 3999) line["test_psnr"] = 25.5;
    text += line.dump() + "\n";
  }
  write_file(folder / "log.jsonl", text + "{\"iteration\": 40");  // torn
  const GrowthLog log = read_growth_log(folder / "log.jsonl");
  CHECK(log.steps == 4000);
  CHECK(log.surfels.x.size() == 100);
  CHECK(log.surfels.x.back() == 4000);
  CHECK(log.surfels.y.back() == 3999);
  CHECK(log.psnr.x.size() == 40);
  for (const double psnr : log.psnr.y) CHECK(psnr == 25);
  CHECK(log.test_psnr.x == std::vector<double>{2000, 4000});
  CHECK(log.test_psnr.y == std::vector<double>{25.5, 25.5});
  CHECK(log.sets.size() == 2);
  CHECK(log.sets.at("interface").x.front() > 2000);
  CHECK(log.sets.at("interface").y.back() == 3999);
  CHECK(read_growth_log(folder / "none").steps == 0);
}
