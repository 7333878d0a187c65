// SPDX-License-Identifier: MIT
#include "reports/figures/priors_figure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "datasets/glassroom/prior_levels.h"
#include "glint/drawing/chart.h"
#include "reports/tables/statistics.h"

namespace glint {

namespace {

struct Score {
  const char *metric, *title, *label;
};
constexpr Score kScores[] = {
    {"psnr@glass", "PSNR on glass", "PSNR (dB)"},
    {"depth-absrel", "depth", "AbsRel"},
    {"transparency-iou", "transparency", "IoU"}};

// Methods stand beside each other at a level, so that their bars can be told apart; of the distance
// between levels.
constexpr double kWidthOfMethods = 0.4;

struct Variant {
  std::string room;  // empty: the scene is named by its level alone
  std::size_t level;
};

std::optional<Variant> variant_of(const std::string& scene) {
  for (std::size_t level = 0; level < kPriorLevels.size(); ++level) {
    const std::string name = kPriorLevels[level], suffix = "-" + name;
    if (scene == name) return Variant{"", level};
    if (scene.size() > suffix.size() && scene.ends_with(suffix))
      return Variant{scene.substr(0, scene.size() - suffix.size()), level};
  }
  return std::nullopt;
}

// Finished records of chosen methods of a room, by level.
using LevelRecords = std::map<std::size_t, std::vector<const Record*>>;

// Of rooms with two levels at least.
std::map<std::string, LevelRecords> rooms_of(
    const std::vector<Record>& records, const MethodChoice& choice
) {
  std::map<std::string, LevelRecords> rooms;
  for (const Record& record : records)
    if (const auto variant = variant_of(record.cell.scene);
        variant && record.ok() && choice.in_studies(record.cell.method))
      rooms[variant->room][variant->level].push_back(&record);
  std::erase_if(rooms, [](const auto& room) { return room.second.size() < 2; });
  return rooms;
}

// What the seeds have at each level; nothing where none has the metric.
std::vector<std::vector<double>> values_of(
    const LevelRecords& levels, const std::string& method, const std::string& metric
) {
  std::vector<std::vector<double>> values(kPriorLevels.size());
  for (const auto& [level, records] : levels)
    for (const Record* record : records)
      if (record->cell.method == method)
        if (const double value = metric_of(*record, metric); std::isfinite(value))
          values[level].push_back(value);
  return values;
}

// `shift`: of the method, along x.
ChartSeries series_of(
    const std::vector<std::vector<double>>& values, std::size_t index, double shift
) {
  ChartSeries series{index, {}, {}};
  for (std::size_t level = 0; level < values.size(); ++level) {
    const bool any = !values[level].empty();
    const auto ends = std::minmax_element(values[level].begin(), values[level].end());
    series.x.push_back(static_cast<double>(level) + shift);
    series.y.push_back(any ? mean_of(values[level]) : std::nan(""));
    series.low.push_back(any ? *ends.first : std::nan(""));
    series.high.push_back(any ? *ends.second : std::nan(""));
  }
  return series;
}

Chart chart_of(const LevelRecords& levels, const Score& score, const ChartMethods& all) {
  Chart chart{"simulated priors", score.label, {}};
  chart.x_names = prior_levels();
  const auto count = static_cast<double>(all.ids().size());
  for (std::size_t i = 0; i < all.ids().size(); ++i) {
    const double shift = kWidthOfMethods * ((static_cast<double>(i) + 0.5) / count - 0.5);
    chart.series.push_back(series_of(values_of(levels, all.ids()[i], score.metric), i, shift));
  }
  return chart;
}

}  // namespace

Drawing priors_figure(const std::vector<Record>& records, const MethodChoice& choice) {
  const ChartMethods all(records);
  ChartSheet sheet{{}, {}, all.titles()};
  for (const Score& score : kScores) sheet.titles.push_back(score.title);
  for (const auto& [room, levels] : rooms_of(records, choice)) {
    const std::string what = "simulated priors, five strengths";
    ChartRow row{room.empty() ? what : room + ": " + what, {}};
    for (const Score& score : kScores) row.charts.push_back(chart_of(levels, score, all));
    sheet.rows.push_back(std::move(row));
  }
  return draw_charts(sheet);
}

Json priors_table(const std::vector<Record>& records, const MethodChoice& choice) {
  Json points = Json::array();
  for (const auto& [room, levels] : rooms_of(records, choice))
    for (const Score& score : kScores)
      for (const std::string& method : figure_methods(records)) {
        const auto values = values_of(levels, method, score.metric);
        for (std::size_t level = 0; level < values.size(); ++level)
          if (const std::vector<double>& seeds = values[level]; !seeds.empty())
            points.push_back(
                {{"room", room},
                 {"method", method},
                 {"metric", score.metric},
                 {"level", kPriorLevels[level]},
                 {"values", seeds},
                 {"mean", mean_of(seeds)},
                 {"low", *std::min_element(seeds.begin(), seeds.end())},
                 {"high", *std::max_element(seeds.begin(), seeds.end())}}
            );
      }
  return points.empty() ? Json() : Json{{"levels", prior_levels()}, {"points", points}};
}

}  // namespace glint
