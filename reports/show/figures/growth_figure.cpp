// SPDX-License-Identifier: MIT
#include "reports/show/figures/growth_figure.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "glint/core/presence.h"
#include "glint/drawing/chart.h"
#include "reports/run/records/cell_filter.h"
#include "reports/run/records/run_folder.h"
#include "reports/show/pictures/growth_log.h"

namespace glint {

namespace {

constexpr std::size_t kColumns = 3;
// In this order, before other sets.
constexpr const char* kFirstSets[] = {"interface", "transmission", "reflection"};

struct Grown {
  std::size_t index;  // of its method
  GrowthLog log;
};
using GrownBySceneAndSteps = std::map<std::pair<std::string, int>, std::vector<Grown>>;

bool is_shown(const FigureOptions& options, const CellKey& cell) {
  const auto& scenes = options.shown.scenes;
  return MethodChoice{options.methods}.in_curves(cell.method) &&
         (scenes.empty() || any_glob_matches(scenes, cell.scene));
}

// Colours stay with their methods.
ChartMethods methods_of(const std::vector<GrowthRun>& runs) {
  std::vector<Record> records;
  for (const GrowthRun& run : runs) {
    records.emplace_back();
    records.back().cell = run.cell;
  }
  return ChartMethods(records);
}

GrownBySceneAndSteps read_logs(const std::vector<GrowthRun>& runs, const ChartMethods& methods) {
  GrownBySceneAndSteps grown;
  for (const GrowthRun& run : runs) {
    Grown one{methods.index_of(run.cell.method), read_growth_log(run.log)};
    if (one.log.steps == 0) continue;
    const int steps = run.steps > 0 ? run.steps : one.log.steps;
    grown[{run.cell.scene, steps}].push_back(std::move(one));
  }
  return grown;
}

// course(log): null where the log has none.
template <class F>
Chart chart_of(const std::vector<Grown>& runs, const std::string& label, bool counts, F&& course) {
  Chart chart{"steps", label, {}};
  chart.logarithmic_y = counts;
  for (const Grown& run : runs)
    if (const Course* found = course(run.log))
      chart.series.push_back({run.index, found->x, found->y});
  return chart;
}

Chart chart_of(
    const std::vector<Grown>& runs, const std::string& label, Course GrowthLog::*course
) {
  return chart_of(runs, label, course == &GrowthLog::surfels, [&](const GrowthLog& log) {
    return &(log.*course);
  });
}

Chart set_chart(const std::vector<Grown>& runs, const std::string& set) {
  return chart_of(runs, "surfels: " + set, true, [&](const GrowthLog& log) {
    const auto it = log.sets.find(set);
    return it == log.sets.end() ? nullptr : &it->second;
  });
}

std::vector<std::string> sets_of(const std::vector<Grown>& runs) {
  std::set<std::string> there;
  for (const Grown& run : runs)
    for (const auto& [name, course] : run.log.sets) there.insert(name);
  std::vector<std::string> sets;
  for (const char* name : kFirstSets)
    if (there.erase(name) > 0) sets.emplace_back(name);
  sets.insert(sets.end(), there.begin(), there.end());
  return sets;
}

void add_rows(const std::string& title, const std::vector<Grown>& runs, ChartSheet& sheet) {
  sheet.rows.push_back(
      {title,
       {chart_of(runs, "surfels", &GrowthLog::surfels),
        chart_of(runs, "PSNR of training views (dB)", &GrowthLog::psnr),
        chart_of(runs, "PSNR of test views (dB)", &GrowthLog::test_psnr)}}
  );
  const std::vector<std::string> sets = sets_of(runs);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (i % kColumns == 0) sheet.rows.push_back({"", {}});
    sheet.rows.back().charts.push_back(set_chart(runs, sets[i]));
  }
}

GrowthRun run_in(const fs::path& folder) {
  const RunSpec spec = read_run_spec(folder);
  return {spec.cell(), spec.options.iterations, folder / "log.jsonl"};
}

// Folders with the log of a run, by name.
std::set<fs::path> runs_below(const fs::path& folder) {
  GLINT_CHECK(is_folder(folder), kUsage, "--runs {}: no such folder", folder.string());
  const auto is_other = [](const fs::path& path) {
    return path.filename() != "log.jsonl" && !is_real_folder(path);
  };
  std::set<fs::path> runs;
  with_exit_code(ExitCode::kBadPrediction, [&] {
    for (const fs::path& log : list_files_below(folder, is_other))
      if (is_there(log.parent_path() / "config.json")) runs.insert(log.parent_path());
  });
  GLINT_CHECK(!runs.empty(), kUsage, "--runs {}: no run with a log there", folder.string());
  return runs;
}

std::vector<fs::path> draw_growth(const GrowthOptions& options) {
  std::vector<GrowthRun> runs = growth_runs_below(options.runs);
  std::erase_if(runs, [&](const GrowthRun& run) {
    return !MethodChoice{options.methods}.in_studies(run.cell.method) ||
           (!options.scenes.empty() && !any_glob_matches(options.scenes, run.cell.scene));
  });
  const Drawing drawing = growth_figure(runs);
  if (drawing.empty()) return {};
  const fs::path png = options.folder / "growth.png";
  write_drawing(png, drawing);
  return {png};
}

}  // namespace

std::vector<GrowthRun> growth_runs(
    const FigureOptions& options, const std::vector<Record>& records
) {
  std::vector<GrowthRun> runs;
  std::set<std::pair<std::string, std::string>> known;
  for (const Record& record : records)
    if (record.ok() && is_shown(options, record.cell) &&
        known.emplace(record.cell.scene, record.cell.method).second)
      runs.push_back(
          {record.cell, record.iterations, run_folder(options.folder, record.cell) / "log.jsonl"}
      );
  return runs;
}

std::vector<GrowthRun> growth_runs_below(const std::vector<std::string>& folders) {
  std::set<fs::path> runs;
  for (const std::string& folder : folders) runs.merge(runs_below(folder));
  std::vector<GrowthRun> found;
  for (const fs::path& run : runs) found.push_back(run_in(run));
  return found;
}

Drawing growth_figure(const std::vector<GrowthRun>& runs) {
  const ChartMethods methods = methods_of(runs);
  ChartSheet sheet{{}, {}, methods.titles()};
  for (const auto& [place, grown] : read_logs(runs, methods))
    add_rows(fmt::format("{}, {} steps", place.first, place.second), grown, sheet);
  return draw_charts(sheet);
}

GLINT_PROVIDE(write_growth, draw_growth)

}  // namespace glint
