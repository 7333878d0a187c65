// SPDX-License-Identifier: MIT
#include "reports/show/page/results_html.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "reports/show/page/static_page.h"
#include "reports/show/page/svg_chart.h"
#include "reports/show/tables/results_page.h"

namespace glint {
namespace {

std::string section_html(const ResultsSection& section) {
  std::vector<std::string> facts;
  for (const std::string& fact : section.facts) facts.push_back(inline_markdown_html(fact));
  std::string html = fmt::format("<h2>{}</h2>\n", page_text(section.title)) + list_html(facts);
  for (const Table& table : section.tables) html += table_html(table);
  return html;
}

std::vector<std::string> point_row(const OrderPoint& point) {
  const auto& interval = point.mean.interval;
  return {
      fmt::format("{}", point.steps),
      point.measured_on(),
      point.title,
      fmt::format("{:.2f}", point.mean.tau),
      interval ? fmt::format("{:.2f} to {:.2f}", interval->low, interval->high) : "none",
      fmt::format("±{:.2f}", point.mean.chance.high),
      point.columns_text(),
      point.records};
}

std::string order_html(const OrderByLength& order) {
  std::vector<std::vector<std::string>> rows;
  for (const OrderPoint& point : order.points) rows.push_back(point_row(point));
  std::vector<std::string> notes = order_notes(order);
  for (std::string& note : notes) note = page_text(note);
  return fmt::format(
      "<h2>{}</h2>\n<section class=\"card\">\n{}{}{}</section>\n",
      page_text(kOrderTitle),
      order_figure(order),
      plain_table_html(
          {"Steps", "Measured on", "Table", "Mean tau", "95 %", "Chance", "Columns", "Records"},
          rows
      ),
      list_html(notes)
  );
}

// Lengths stand by their logarithm.
std::vector<SvgTick> ticks_of(const OrderByLength& order) {
  std::set<int> steps;
  for (const OrderPoint& point : order.points) steps.insert(point.steps);
  std::vector<SvgTick> ticks;
  for (const int count : steps)
    ticks.push_back({std::log(static_cast<double>(count)), fmt::format("{}", count)});
  return ticks;
}

}  // namespace

std::string order_figure(const OrderByLength& order) {
  SvgChart chart;
  chart.title = "Kendall's tau of the order of methods against the paper's, by steps of training";
  chart.x_label = "steps of training";
  chart.y_label = "Kendall's tau";
  chart.x_ticks = ticks_of(order);
  chart.y = {-1, 1};
  for (const OrderPoint& point : order.points) {
    const auto known = std::find_if(chart.series.begin(), chart.series.end(), [&](const auto& one) {
      return one.name == point.series();
    });
    SvgSeries& series = known != chart.series.end()
                            ? *known
                            : chart.series.emplace_back(SvgSeries{point.series(), {}, {}, {}});
    series.x.push_back(std::log(static_cast<double>(point.steps)));
    series.y.push_back(point.mean.tau);
    series.intervals.push_back(point.mean.interval);
    const double chance = point.mean.chance.high;
    if (!chart.band || chance > chart.band->high) chart.band = Interval{-chance, chance};
  }
  chart.band_name = "95 % of random orders";
  return svg_chart(chart);
}

std::string results_html(const fs::path& root) {
  std::string body =
      "<p class=\"caption\">The tables of the committed records, written by "
      "<code>glint-bench results</code>; <a href=\"RESULTS.md\">RESULTS.md</a> has the same. A "
      "pointer on a number is told its interval, scenes and seeds.</p>\n";
  body += order_html(order_by_length(root));
  for (const ResultsSection& section : results_sections(root)) body += section_html(section);
  return static_page("GLINT Bench: results", body);
}

}  // namespace glint
