// SPDX-License-Identifier: MIT
#include "reports/show/board/board_page.h"

#include <algorithm>

#include "glint/core/presence.h"
#include "reports/run/records/revision.h"
#include "reports/show/board/board_history.h"
#include "reports/show/page/static_page.h"
#include "reports/show/page/svg_chart.h"
#include "reports/show/tables/table_cells.h"
#include "reports/show/tables/table_writers.h"

namespace glint {
namespace {

constexpr const char* kPage = "index.html";
constexpr const char* kJson = "leaderboard.json";

std::string joined(const std::vector<std::string>& texts) {
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string card(const std::string& title, const std::string& body) {
  return fmt::format(
      "<section class=\"card\">\n<h3>{}</h3>\n{}</section>\n", page_text(title), body
  );
}

// A card that opens.
std::string closed_card(const std::string& title, const std::string& body) {
  return fmt::format(
      "<details class=\"card\">\n<summary>{}</summary>\n{}</details>\n", page_text(title), body
  );
}

std::vector<std::string> source_row(const TableRow& row, const BoardSource& source) {
  return {
      row.title,
      source.store,
      source.commit,
      source.scored_by,
      source.device,
      source.dates(),
      joined(source.scenes),
      fmt::format("{}", fmt::join(source.seeds, ", ")),
      fmt::format("{}", source.num_records)};
}

std::string sources_html(const BoardGroup& group, const Table& table) {
  std::vector<std::vector<std::string>> rows;
  for (const TableRow& row : table.rows)
    for (const BoardSource& source : board_sources(group, row.method))
      rows.push_back(source_row(row, source));
  return closed_card(
      "Where the numbers come from",
      plain_table_html(
          {"Method",
           "Store",
           "Commit",
           "Scored by",
           "Device",
           "Date",
           "Scenes",
           "Seeds",
           "Records"},
          rows
      )
  );
}

std::string signed_text(double value, int decimals) {
  return fmt::format("{}{}", value < 0 ? "" : "+", format_value(value, decimals));
}

std::string history_text(const HistoryValue& value, const TableColumn& column) {
  std::string text = shown_text(value.cell, column);
  if (value.change)
    text +=
        fmt::format(" ({} over {})", signed_text(*value.change, column.decimals), value.num_pairs);
  return text;
}

// Commits in the order of their first day in the history.
std::vector<std::pair<std::string, std::string>> days_of_commits(
    const std::vector<HistoryEntry>& history
) {
  std::vector<std::pair<std::string, std::string>> days;  // day, commit
  for (const HistoryEntry& entry : history) {
    const auto known = std::find_if(days.begin(), days.end(), [&](const auto& day) {
      return day.second == entry.commit;
    });
    if (known == days.end())
      days.emplace_back(entry.date, entry.commit);
    else
      known->first = std::min(known->first, entry.date);
  }
  std::stable_sort(days.begin(), days.end());
  return days;
}

// The first column's means by commit, of methods and commits with all scenes; others are no points
// of one line.
std::vector<SvgSeries> history_series(
    const std::vector<HistoryEntry>& history,
    const std::vector<std::pair<std::string, std::string>>& days
) {
  std::vector<SvgSeries> all;
  for (const HistoryEntry& entry : history) {
    const TableCell& cell = entry.values.front().cell;
    if (all.empty() || all.back().name != entry.title) all.push_back({entry.title, {}, {}, {}});
    if (cell.status != CellStatus::kOk) continue;
    const auto at = std::find_if(days.begin(), days.end(), [&](const auto& day) {
      return day.second == entry.commit;
    });
    all.back().x.push_back(static_cast<double>(at - days.begin()));
    all.back().y.push_back(cell.value);
  }
  std::erase_if(all, [](const SvgSeries& series) { return series.x.size() < 2; });
  return all;
}

// Empty: no method has two points.
std::string history_chart(const std::vector<HistoryEntry>& history, const TableColumn& column) {
  constexpr std::size_t kLabels = 8;
  const auto days = days_of_commits(history);
  SvgChart chart;
  chart.title = fmt::format("{} by commit", column.title);
  chart.x_label = "commit";
  chart.y_label = shown_title(column);
  chart.decimals = column.decimals;
  chart.series = history_series(history, days);
  if (chart.series.empty()) return "";
  const std::size_t every = (days.size() + kLabels - 1) / kLabels;
  for (std::size_t i = 0; i < days.size(); ++i) {
    const bool is_named = i % every == 0;
    chart.x_ticks.push_back(
        {static_cast<double>(i), is_named ? days[i].second.substr(0, 7) : std::string()}
    );
  }
  chart.y = range_around(chart.series);
  return svg_chart(chart);
}

std::string history_html(const BoardGroup& group, const Table& table) {
  const auto history = board_history(group, table);
  const auto columns = measured_columns(table);
  if (history.empty() || columns.empty()) return "";
  std::vector<std::string> head{"Method", "Commit", "Date", "Stores"};
  for (const TableColumn* column : columns) head.push_back(shown_title(*column));
  std::vector<std::vector<std::string>> rows;
  for (const HistoryEntry& entry : history) {
    rows.push_back({entry.title, entry.commit, entry.date, joined(entry.stores)});
    for (std::size_t i = 0; i < columns.size(); ++i)
      rows.back().push_back(history_text(entry.values[i], *columns[i]));
  }
  return card(
      "History by commit",
      history_chart(history, *columns.front()) + plain_table_html(head, rows) +
          list_html({"In brackets: the change since the commit before, over so many scenes and "
                     "seeds that "
                     "both have. * a mean over fewer scenes than the group has."})
  );
}

std::string group_html(const BoardGroup& group) {
  const Table table = board_table(group);
  // Columns of the page's table are those that somebody has.
  const Table shown = without_empty_columns(table);
  const CellHint hint = [&](const TableRow& row, std::size_t i) {
    std::vector<std::string> texts;
    for (const BoardSource& source : board_sources(group, row.method, shown.columns[i].metric))
      texts.push_back(source.text());
    return fmt::format("{}", fmt::join(texts, "; "));
  };
  return table_html(table, hint) + sources_html(group, table) + history_html(group, table);
}

std::string contradictions_html(const Board& board) {
  if (board.contradictions.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  for (const auto& [cell, kept, other, why] : board.contradictions)
    rows.push_back({cell.text(), kept, other, why});
  return card(
      "Stores that contradict each other",
      plain_table_html({"Cell", "Shown: that of", "Left out: that of", "What differs"}, rows)
  );
}

std::string stores_html(const Board& board) {
  std::vector<std::vector<std::string>> rows;
  for (const BoardStore& store : board.stores)
    rows.push_back({store.name, fmt::format("{}", store.num_records)});
  return card("Stores", plain_table_html({"Store", "Records"}, rows));
}

Json source_json(const BoardSource& source) {
  return {
      {"store", source.store},
      {"commit", source.commit},
      {"scored_by", source.scored_by.empty() ? source.commit : source.scored_by},
      {"device", source.device},
      {"first_date", source.first_date},
      {"last_date", source.last_date},
      {"scenes", source.scenes},
      {"seeds", source.seeds},
      {"records", source.num_records}};
}

Json sources_json(const BoardGroup& group, const Table& table) {
  Json json = Json::object();
  for (const TableRow& row : table.rows)
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (table.columns[i].published || !row.cells[i].has_value()) continue;
      Json& cell = json[row.method][table.columns[i].id] = Json::array();
      for (const BoardSource& source : board_sources(group, row.method, table.columns[i].metric))
        cell.push_back(source_json(source));
    }
  return json;
}

Json history_json(const BoardGroup& group, const Table& table) {
  const auto columns = measured_columns(table);
  Json json = Json::array();
  for (const HistoryEntry& entry : board_history(group, table)) {
    Json values = Json::object();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const HistoryValue& value = entry.values[i];
      if (!value.cell.has_value()) continue;
      values[columns[i]->id] = {
          {"value", value.cell.value},
          {"n_scenes", value.cell.num_scenes},
          {"n_seeds", value.cell.num_seeds},
          {"change", value.change ? Json(*value.change) : Json()},
          {"n_pairs", value.num_pairs}};
    }
    json.push_back(
        {{"method", entry.method},
         {"commit", entry.commit},
         {"date", entry.date},
         {"stores", entry.stores},
         {"values", std::move(values)}}
    );
  }
  return json;
}

Json group_json(const BoardGroup& group) {
  const Table table = board_table(group);
  return {
      {"title", group.title()},
      {"dataset", group.dataset},
      {"resolution", group.resolution},
      {"steps", group.steps > 0 ? Json(group.steps) : Json()},
      {"data", group.hashes},
      {"table", table_json(table)},
      {"sources", sources_json(group, table)},
      {"history", history_json(group, table)}};
}

void check_folder(const fs::path& folder) {
  GLINT_CHECK(
      !is_there(folder / kPage) || is_there(folder / kJson),
      kUsage,
      "{}: has an {} that is of no leaderboard; give another --out",
      folder.string(),
      kPage
  );
}

}  // namespace

std::string board_html(const Board& board) {
  std::string body =
      "<p class=\"caption\">Results that can be compared stand in one table: of the same data, "
      "image "
      "size and steps. A pointer on a number is told its store, commit, device and date. The same "
      "values: <a href=\"leaderboard.json\">leaderboard.json</a>.</p>\n";
  body += contradictions_html(board);
  for (const BoardGroup& group : board.groups) body += group_html(group);
  return static_page("GLINT Bench: leaderboard", body + stores_html(board));
}

Json board_json(const Board& board) {
  Json json = {{"schema", kBoardSchema}, {"written_by", git_revision()}};
  json["stores"] = Json::array();
  for (const BoardStore& store : board.stores)
    json["stores"].push_back({{"name", store.name}, {"records", store.num_records}});
  json["groups"] = Json::array();
  for (const BoardGroup& group : board.groups) json["groups"].push_back(group_json(group));
  json["contradictions"] = Json::array();
  for (const auto& [cell, kept, other, why] : board.contradictions)
    json["contradictions"].push_back(
        {{"scene", cell.scene},
         {"method", cell.method},
         {"seed", cell.seed},
         {"kept", kept},
         {"left_out", other},
         {"why", why}}
    );
  return json;
}

fs::path write_board(const Board& board, const fs::path& folder) {
  check_folder(folder);
  const std::string json =
      board_json(board).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::string page = board_html(board);
  write_file(folder / kJson, json);
  write_file(folder / kPage, page);
  return folder / kPage;
}

}  // namespace glint
