// SPDX-License-Identifier: MIT
#include "reports/show/page/page_summary.h"

#include <map>
#include <set>

#include "metrics/metric.h"
#include "reports/run/records/revision.h"
#include "reports/run/records/script_text.h"
#include "reports/show/tables/main_methods.h"
#include "reports/show/tables/method_title.h"
#include "reports/show/tables/table_writers.h"

namespace glint {

namespace {

std::string direction_name(RankOrder order) {
  if (order == RankOrder::kHigherFirst) return "higher";
  return order == RankOrder::kLowerFirst ? "lower" : "none";
}

std::vector<std::string> metric_ids(const std::vector<Record>& records) {
  std::set<std::string> ids;
  for (const Record& record : records)
    for (const auto& [id, value] : record.metrics) ids.insert(id);
  return {ids.begin(), ids.end()};
}

// Units, directions and decimals: of the registered metrics, and of the costs that tables have.
Json metrics_json(const std::vector<std::string>& ids, const std::vector<Table>& tables) {
  Json json = Json::object();
  for (const Table& table : tables)
    for (const TableColumn& column : table.columns)
      if (!column.metric.empty() && column.scale == 1)
        json[column.metric] = {
            {"unit", column.unit},
            {"direction", direction_name(column.order)},
            {"decimals", column.decimals}};
  for (const std::string& id : ids)
    if (const Metric* metric = find_metric(id))
      json[id] = {
          {"unit", metric->unit}, {"direction", metric->direction}, {"decimals", metric->decimals}};
  return json;
}

// Columns by position, so that 10,000 records stay a small file.
Json records_json(const std::vector<Record>& records, const std::vector<std::string>& ids) {
  Json rows = Json::array();
  for (const Record& record : records) {
    Json row = {
        record.dataset,
        record.cell.scene,
        record.cell.method,
        record.cell.seed,
        record.ok(),
        record.resolution,
        record.num_surfels,
        record.environment.value("date", Json())};
    for (const std::string& id : ids) {
      const auto it = record.metrics.find(id);
      row.push_back(it == record.metrics.end() ? Json() : short_number(it->second));
    }
    rows.push_back(std::move(row));
  }
  return {{"metrics", ids}, {"rows", std::move(rows)}};
}

// Method id -> as people read it.
Json titles_json(const std::vector<Record>& records) {
  Json titles = Json::object();
  for (const Record& record : records)
    titles[record.cell.method] = method_title(record.cell.method);
  return titles;
}

// Methods that were given the truth: nothing is ranked against them.
Json no_rivals_json(const std::vector<Record>& records) {
  std::set<std::string> ids;
  for (const Record& record : records)
    if (!is_rival(record.cell.method)) ids.insert(record.cell.method);
  return ids;
}

Json failures_json(const std::vector<PageScene>& scenes, const PageOptions& options) {
  Json failures = Json::array();
  for (const PageScene& scene : scenes)
    for (const PageRun& run : scene.runs)
      if (!run.record->ok()) {
        const Failure& failure = *run.record->failure;
        failures.push_back(
            {{"cell", run.record->cell.text()},
             {"stage", failure.stage},
             {"kind", failure.kind},
             {"message", failure.message},
             {"log_tail", failure.log_tail},
             {"date", run.record->environment.value("date", Json())},
             {"command", run_commands(run, options).front()["command"]}}
        );
      }
  return failures;
}

// Machines and builds that the records come from, with how many each.
Json environments_json(const std::vector<Record>& records) {
  constexpr const char* kFields[] = {
      "device", "driver", "cpu", "cores", "threads", "memory_bytes", "compiler", "git_revision"};
  std::map<std::string, int> counts;
  for (const Record& record : records) {
    Json environment = Json::object();
    for (const char* field : kFields) environment[field] = record.environment.value(field, Json());
    ++counts[environment.dump(-1, ' ', false, Json::error_handler_t::replace)];
  }
  Json json = Json::array();
  for (const auto& [text, count] : counts) {
    json.push_back(Json::parse(text));
    json.back()["records"] = count;
  }
  return json;
}

std::string date_range(const std::vector<Record>& records) {
  std::set<std::string> dates;
  for (const Record& record : records)
    if (const Json date = record.environment.value("date", Json()); date.is_string())
      dates.insert(date.get<std::string>());
  if (dates.empty()) return "";
  return *dates.begin() == *dates.rbegin() ? *dates.begin()
                                           : *dates.begin() + " – " + *dates.rbegin();
}

}  // namespace

Json page_summary(
    const PageOptions& options,
    const std::vector<Table>& tables,
    const std::vector<Record>& records,
    const std::vector<PageScene>& scenes
) {
  const auto ids = metric_ids(records);
  Json json = {
      {"profile", fs::path(options.profile).stem().string()},
      {"version", git_revision()},
      {"dates", date_range(records)},
      {"command",
       fmt::format(
           "glint-bench report --profile {} --out {}",
           shell_word(options.profile),
           shell_word(options.out)
       )},
      {"shades", kRankShades}};
  json["tables"] = Json::array();
  for (const Table& table : tables) json["tables"].push_back(table_json(table));
  json["metrics"] = metrics_json(ids, tables);
  json["records"] = records_json(records, ids);
  json["titles"] = titles_json(records);
  json["no_rivals"] = no_rivals_json(records);
  json["main_methods"] = main_methods();
  json["mesh_faces"] = mesh_faces(options);
  json["failures"] = failures_json(scenes, options);
  json["environments"] = environments_json(records);
  json["scenes"] = Json::array();
  for (const PageScene& scene : scenes)
    json["scenes"].push_back({{"name", scene.name}, {"dataset", scene.dataset}});
  return json;
}

}  // namespace glint
