// SPDX-License-Identifier: MIT
// Pages without a program: the committed results, tables, small charts.
#include "reports/show/page/results_html.h"

#include <catch2/catch.hpp>

#include <algorithm>

#include "reports/show/page/static_page.h"
#include "reports/show/page/svg_chart.h"
#include "tests/support/table_parts.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

const std::string kHostile = "</style><script>alert(1)</script><img src=x onerror=\"alert(1)\">";

// No program, nothing that is loaded from anywhere.
void check_asks_for_nothing(const std::string& html) {
  for (const char* word : {"<script", "<img", "<link rel=\"stylesheet", "@import", "url("}) {
    INFO(word);
    CHECK(html.find(word) == std::string::npos);
  }
}

}  // namespace

TEST_CASE("docs/results/index.html and the figure are what the committed records give") {
  INFO("run `glint-bench results` and commit what it writes");
  const std::string page = read_file(kResultsPage);
  CHECK(page == results_html("."));
  CHECK(read_file(kOrderFigure) == order_figure(order_by_length(fs::path("."))));
  check_asks_for_nothing(page);
  for (const char* part : {"GLINT", "rank-1", "Order of methods by length", "<svg", "</html>"})
    CHECK_THAT(page, Contains(part));
}

TEST_CASE("cells of a page have their marks, and a pointer is told what they are") {
  const Table table =
      build_table(definition_of("summary"), {record_of("2dgs", 20), record_of("glint", 30)});
  const std::string html =
      table_html(table, [](const TableRow& row, std::size_t) { return "from " + row.method; });
  CHECK_THAT(
      html,
      Contains("<td class=\"number rank-1\" title=\"best · 1 scenes, 1 seeds · from "
               "glint\">30.00</td>")
  );
  CHECK_THAT(html, Contains("rank-2") && Contains("missing") && Contains("Empty columns: "));
  CHECK_THAT(html, !Contains("<th scope=\"col\">AbsRel"));
}

TEST_CASE("names on a page stay text") {
  Table table = build_table(definition_of("summary"), {record_of(kHostile, 20)});
  table.title = table.caption = kHostile;
  std::string page =
      static_page(kHostile, table_html(table) + plain_table_html({"a"}, {{kHostile}}));
  page += inline_markdown_html("`" + kHostile + "` [a](b)");
  check_asks_for_nothing(page);
  CHECK_THAT(page, Contains("&lt;script&gt;") && Contains("<a href=\"b\">a</a>"));
  SvgChart chart;
  chart.title = chart.x_label = chart.y_label = chart.band_name = kHostile;
  chart.band = Interval{0, 1};
  chart.x_ticks = {{0, kHostile}};
  chart.series = {{kHostile, {0, 0}, {0.5, std::nan("")}, {}}};
  const std::string svg = svg_chart(chart);
  check_asks_for_nothing(svg);
  CHECK(std::count(svg.begin(), svg.end(), '<') == std::count(svg.begin(), svg.end(), '>'));
  CHECK_THAT(svg, !Contains("nan"));
}

TEST_CASE("a chart has room around its values") {
  CHECK(range_around({}).high == 1);
  const Interval range = range_around({{"a", {0, 1}, {10, 20}, {}}});
  CHECK(range.low == Approx(9));
  CHECK(range.high == Approx(21));
  CHECK(range_around({{"a", {0}, {10}, {}}}).high > 10);
}
