// SPDX-License-Identifier: MIT
#include "reports/show/figures/curve_figures.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "glint/drawing/chart.h"
#include "metrics/mesh/mesh_protocol.h"
#include "reports/run/records/run_folder.h"
#include "reports/show/figures/figure_methods.h"
#include "reports/show/pictures/training_curve.h"
#include "reports/show/tables/statistics.h"

namespace glint {

namespace {

constexpr std::size_t kCurvePoints = 100;

using RecordPointers = std::vector<const Record*>;
using MethodRecords = std::vector<std::pair<std::string, RecordPointers>>;
using SceneRecords = std::vector<std::pair<std::string, MethodRecords>>;

// Finished records of each scene and chosen method, in the order of the records.
SceneRecords finished_runs(const std::vector<Record>& records, const MethodChoice& choice) {
  SceneRecords scenes;
  const auto entry = [](auto& list, const std::string& name) -> auto& {
    const auto it = std::find_if(list.begin(), list.end(), [&](const auto& candidate) {
      return candidate.first == name;
    });
    if (it != list.end()) return it->second;
    list.push_back({name, {}});
    return list.back().second;
  };
  for (const Record& record : records)
    if (record.ok() && choice.in_curves(record.cell.method))
      entry(entry(scenes, record.cell.scene), record.cell.method).push_back(&record);
  return scenes;
}

std::vector<double> numbers_of(const Json& array) {
  std::vector<double> numbers;
  for (const Json& value : array)
    numbers.push_back(value.is_number() ? value.get<double>() : std::nan(""));
  return numbers;
}

Chart training_chart(
    const MethodRecords& methods, const fs::path& folder, const ChartMethods& all
) {
  Chart chart{"iteration", "PSNR of training views (dB)", {}};
  for (const auto& [method, runs] : methods) {
    const fs::path log = run_folder(folder, runs.front()->cell) / "log.jsonl";
    const Json curve = training_curve(log, kCurvePoints);
    chart.series.push_back({all.index_of(method), {}, {}});
    if (!curve.is_object()) continue;
    chart.series.back().x = numbers_of(curve.at("iteration"));
    chart.series.back().y = numbers_of(curve.at("psnr"));
  }
  return chart;
}

Chart scatter_chart(
    const MethodRecords& methods,
    const std::string& x_metric,
    const std::string& x_label,
    const ChartMethods& all
) {
  Chart chart{x_label, "PSNR of test views (dB)", {}};
  for (const auto& [method, runs] : methods) {
    ChartSeries series{all.index_of(method), {}, {}, true};
    for (const Record* record : runs) {
      series.x.push_back(metric_of(*record, x_metric));
      series.y.push_back(metric_of(*record, "psnr"));
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

// Fewer than two distances may have been measured.
ChartSeries f1_series(const RecordPointers& runs, const char* prefix) {
  ChartSeries series;
  for (const double threshold : default_thresholds_m()) {
    const std::string id = prefix + mesh_metric_id("f1@" + threshold_name(threshold), {});
    std::vector<double> values;
    for (const Record* record : runs)
      if (const double value = metric_of(*record, id); std::isfinite(value))
        values.push_back(value);
    if (values.empty()) continue;
    series.x.push_back(100 * threshold);
    series.y.push_back(mean_of(values));
  }
  return series;
}

Chart f1_chart(const MethodRecords& methods, const char* prefix, const ChartMethods& all) {
  Chart chart{"distance (cm)", "F1", {}};
  for (const auto& [method, runs] : methods)
    if (ChartSeries series = f1_series(runs, prefix); series.x.size() >= 2) {
      series.index = all.index_of(method);
      chart.series.push_back(std::move(series));
    }
  return chart;
}

}  // namespace

Drawing curves_figure(
    const std::vector<Record>& records, const fs::path& folder, const MethodChoice& choice
) {
  const ChartMethods all(records);
  ChartSheet sheet{{"training", "quality and time", "quality and size"}, {}, all.titles()};
  for (const auto& [scene, methods] : finished_runs(records, choice))
    sheet.rows.push_back(
        {scene,
         {training_chart(methods, folder, all),
          scatter_chart(methods, "train-minutes", "training (min)", all),
          scatter_chart(methods, "num-surfels", "surfels", all)}}
    );
  return draw_charts(sheet);
}

Drawing f1_figure(const std::vector<Record>& records, const MethodChoice& choice) {
  const ChartMethods all(records);
  ChartSheet sheet{{"mesh", "mesh behind glass"}, {}, all.titles()};
  for (const auto& [scene, methods] : finished_runs(records, choice))
    sheet.rows.push_back({scene, {f1_chart(methods, "", all), f1_chart(methods, kBehindMesh, all)}}
    );
  return draw_charts(sheet);
}

}  // namespace glint
