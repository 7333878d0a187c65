// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "glint/core/rows.h"
#include "reports/show/tables/compare.h"
#include "reports/show/tables/table_writers.h"

namespace glint {

namespace {

std::string_view verdict_word(const ValueChange& change) {
  if (change.regression) return "regression";
  switch (change.verdict) {
    case Verdict::kWorse:
      return "worse (cost)";
    case Verdict::kBetter:
      return "better";
    case Verdict::kOther:
      return "changed";
    case Verdict::kWithinSpread:
      return "within spread";
  }
  return "changed";
}

using Wanted = bool (*)(const ValueChange&);

Rows rows_of(const Comparison& comparison, Wanted wanted) {
  Rows rows(
      {{"", "scene/method"},
       {"metric", "metric", "{}"},
       {"before", "before", "{:.5g}"},
       {"after", "after", "{:.5g}"},
       {"difference", "difference", "{:+.3g}"},
       {"allowed", "allowed", "± {:.3g}"},
       {"verdict", "verdict"}},
      "scene method n_seeds regression"
  );
  for (const ValueChange& change : comparison.values)
    if (wanted(change))
      rows.add(
          {change.scene + "/" + change.method,
           {change.metric, fmt::format("{} {}", change.metric, order_arrow(change.order))},
           change.before,
           change.after,
           change.difference(),
           change.allowed,
           verdict_word(change),
           change.scene,
           change.method,
           change.num_seeds,
           change.regression}
      );
  return rows;
}

bool any(const ValueChange&) { return true; }
bool within(const ValueChange& change) { return change.verdict == Verdict::kWithinSpread; }
bool beyond(const ValueChange& change) { return !within(change); }

std::string count(std::size_t number, std::string_view what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

std::string summary_line(const Comparison& comparison) {
  const auto num_beyond = std::count_if(comparison.values.begin(), comparison.values.end(), beyond);
  return fmt::format(
      "{}; {} and {} compared, {} beyond the spread, {} within it",
      count(comparison.num_regressions(), "regression"),
      count(comparison.num_cells, "cell"),
      count(comparison.num_values, "value"),
      num_beyond,
      static_cast<std::ptrdiff_t>(comparison.values.size()) - num_beyond
  );
}

std::string rule_line(const Comparison& comparison) {
  return fmt::format(
      "Means over the seeds that both stores have. Allowed: the larger spread over seeds (standard "
      "deviation; of two seeds, their range), or {:g} % of the value before where there is one "
      "seed.",
      100 * comparison.tolerance
  );
}

// What is not a value, a line each.
std::vector<std::string> other_lines(const Comparison& comparison) {
  std::vector<std::string> lines;
  for (const CellChange& change : comparison.cells)
    lines.push_back(fmt::format(
        "{}{}: {}", change.regression ? "regression: " : "", change.cell.text(), change.what
    ));
  for (const CellKey& cell : comparison.before_only) lines.push_back(cell.text() + ": only before");
  for (const CellKey& cell : comparison.after_only) lines.push_back(cell.text() + ": only after");
  lines.insert(lines.end(), comparison.notes.begin(), comparison.notes.end());
  for (std::string& line : lines) std::replace(line.begin(), line.end(), '\n', ' ');
  return lines;
}

std::string markdown_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += fmt::format(" {} |", markdown_text(cell));
  row += "\n";
  return row;
}

// Empty where no value is wanted.
std::string markdown_table(const Comparison& comparison, Wanted wanted) {
  const Rows rows = rows_of(comparison, wanted);
  if (rows.empty()) return "";
  const auto lines = rows.lines();
  std::string text = "\n";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += markdown_row(lines[i]);
    if (i == 0) text += "|---|---|---:|---:|---:|---:|---|\n";
  }
  return text;
}

Json cells_json(const std::vector<CellKey>& cells) {
  Json json = Json::array();
  for (const CellKey& cell : cells) json.push_back(cell.text());
  return json;
}

}  // namespace

std::string comparison_text(const Comparison& comparison) {
  std::string text = comparison.values.empty() ? "" : rows_of(comparison, any).text();
  for (const std::string& line : other_lines(comparison)) text += line + "\n";
  return text + rule_line(comparison) + "\n" + summary_line(comparison) + "\n";
}

std::string comparison_markdown(const Comparison& comparison) {
  std::string text = fmt::format("**{}**\n", summary_line(comparison));
  text += markdown_table(comparison, beyond) + "\n";
  for (const std::string& line : other_lines(comparison))
    text += fmt::format("- {}\n", markdown_text(line));
  if (const std::string table = markdown_table(comparison, within); !table.empty())
    text += "\n<details><summary>Within the spread</summary>\n" + table + "\n</details>\n";
  return text + "\n" + rule_line(comparison) + "\n";
}

Json comparison_json(const Comparison& comparison) {
  Json json = {
      {"regressions", comparison.num_regressions()},
      {"n_cells", comparison.num_cells},
      {"n_values", comparison.num_values},
      {"tolerance", comparison.tolerance},
      {"values", rows_of(comparison, any).json()},
      {"cells", Json::array()},
      {"before_only", cells_json(comparison.before_only)},
      {"after_only", cells_json(comparison.after_only)},
      {"notes", comparison.notes}};
  for (const CellChange& change : comparison.cells)
    json["cells"].push_back(
        {{"cell", change.cell.text()}, {"what", change.what}, {"regression", change.regression}}
    );
  return json;
}

}  // namespace glint
