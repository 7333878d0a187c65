// SPDX-License-Identifier: MIT
#include "reports/show/tables/published.h"

#include <catch2/catch.hpp>

#include <map>
#include <set>

#include "reports/show/tables/tables.h"

using namespace glint;

TEST_CASE("every printed cell of the paper's four tables is there once") {
  std::map<std::string, int> cells;
  std::set<std::string> keys;
  for (const PublishedValue& value : published_values()) {
    ++cells[value.table];
    keys.insert(value.table + value.dataset + value.row + value.column);
  }
  // 6 methods x 2 datasets x 3; 6 methods x 8; 7 rows x 5; 3 methods x 5.
  CHECK(cells == std::map<std::string, int>{{"1", 36}, {"2", 48}, {"3", 35}, {"B", 15}});
  CHECK(keys.size() == published_values().size());
}

TEST_CASE("published numbers keep their printed digits") {
  const PublishedValue* ssim = find_published("1", "3D-FRONT-T", "TSGS", "SSIM");
  REQUIRE(ssim);
  CHECK(ssim->text == "0.87");
  const PublishedValue* psnr = find_published("3", "3D-FRONT-T", "w/o G_refl", "PSNR");
  REQUIRE(psnr);
  CHECK(psnr->text == "32.70");
  CHECK(psnr->decimals == 2);
}

TEST_CASE("hours compare as minutes and print as printed") {
  const PublishedValue* time = find_published("B", "3D-FRONT-T", "GLINT", "Training Time");
  REQUIRE(time);
  CHECK(time->text == "~2.5 h");
  CHECK(time->value == 150);
  CHECK(time->unit == "min");
}

TEST_CASE("a cell that the paper does not have is absent") {
  CHECK(find_published("B", "3D-FRONT-T", "2DGS", "FPS") == nullptr);
}

TEST_CASE("table definitions agree with the paper on rows, columns and which way is better") {
  for (const TableDefinition& definition : table_definitions())
    for (const std::string& dataset : definition.paper_datasets)
      for (const TableColumn& column : definition.columns) {
        if (column.paper_column.empty()) continue;
        int found = 0;
        for (const TableRowDefinition& row : definition.rows)
          if (const auto* value = find_published(
                  definition.paper_table, dataset, row.paper_row, column.paper_column
              )) {
            ++found;
            CHECK((value->direction == "higher") == (column.order == RankOrder::kHigherFirst));
            const std::string unit = value->unit == "1" ? "" : value->unit;
            INFO(column.metric << ": " << column.unit << ", published " << value->unit);
            CHECK(unit == column.unit);
          }
        INFO(definition.id << " " << dataset << " " << column.paper_column);
        CHECK(found >= (dataset == "DL3DV-10K" ? 6 : 3));
      }
}
