// SPDX-License-Identifier: MIT
#include "metrics/tools/tool_output.h"

#include <algorithm>
#include <optional>
#include <ostream>

#include "glint/core/printable.h"
#include "glint/core/rows.h"
#include "metrics/metric.h"

namespace glint {
namespace {

std::optional<double> find_score(const ToolScores& scores, const std::string& id) {
  for (const auto& [name, value] : scores)
    if (name == id) return value;
  return std::nullopt;
}

// Two digits more than tables print.
std::string rounded(const std::string& id, std::optional<double> value) {
  const Metric* metric = find_metric(id);
  const int decimals = metric ? metric->decimals + 2 : 6;
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

// A path, where there is one: maps in memory have none.
void add_path(Json& json, const char* name, const fs::path& path) {
  if (!path.empty()) json[name] = path.string();
}

Json image_json(const ImageScores& image) {
  Json json = {{"name", image.files.name}};
  add_path(json, "prediction", image.files.prediction);
  add_path(json, "reference", image.files.reference);
  add_path(json, "mask", image.files.mask);
  add_path(json, "glass", image.files.glass);
  json["metrics"] = scores_json(image.scores);
  if (!image.warnings.empty()) json["warnings"] = image.warnings;
  return json;
}

std::string summary_text(const Json& value) {
  return value.is_number_float() ? fmt::format("{:.4f}", value.get<double>()) : value.dump();
}

void print_table(const ToolReport& report, const ToolScores& means, std::ostream& out) {
  std::vector<Column> columns{{"", " "}};
  for (const auto& [id, mean] : means) columns.push_back({"", id, "{}"});
  Rows rows(columns);
  const auto add = [&](const std::string& name, const ToolScores& scores) {
    std::vector<Cell> cells{name};
    for (const auto& [id, mean] : means) cells.emplace_back(rounded(id, find_score(scores, id)));
    rows.add(cells);
  };
  for (const ImageScores& image : report.images) add(image.files.name, image.scores);
  add("mean", means);
  out << rows.text();
}

}  // namespace

Json scores_json(const ToolScores& scores) {
  Json json = Json::object();
  for (const auto& [id, value] : scores) json[id] = value;
  return json;
}

void print_scores(const ToolScores& scores, std::ostream& out) {
  for (const auto& [id, value] : scores) {
    const Metric* metric = find_metric(id);
    const std::string unit = metric && !metric->unit.empty() ? " " + metric->unit : "";
    out << fmt::format("{} {}{}\n", id, rounded(id, value), unit);
  }
}

ToolScores mean_scores(std::span<const ImageScores> images) {
  ToolScores means;
  for (const ImageScores& image : images)
    for (const auto& score : image.scores)
      if (!find_score(means, score.first)) means.emplace_back(score.first, 0.0);
  for (auto& mean : means) {
    double sum = 0;
    int count = 0;
    for (const ImageScores& image : images)
      if (const auto value = find_score(image.scores, mean.first)) sum += *value, ++count;
    mean.second = sum / count;
  }
  return means;
}

void print_text(const MetricTool& tool, const ToolReport& report, std::ostream& out) {
  const ToolScores means = mean_scores(report.images);
  if (report.images.size() == 1)
    print_scores(means, out);
  else
    print_table(report, means, out);
  const Json summary = tool.summary(report.images);
  for (const auto& [key, value] : summary.items()) out << key << " " << summary_text(value) << "\n";
  for (const ImageScores& image : report.images)
    for (const std::string& warning : image.warnings)
      out << "warning: " << printable(warning) << "\n";
}

void print_csv(const ToolReport& report, std::ostream& out) {
  const ToolScores means = mean_scores(report.images);
  out << "name";
  for (const auto& mean : means) out << "," << mean.first;
  out << "\n";
  const auto print_row = [&](const std::string& name, const ToolScores& scores) {
    out << csv_field(name);
    for (const auto& mean : means) {
      const auto value = find_score(scores, mean.first);
      out << "," << (value ? fmt::format("{}", *value) : "");
    }
    out << "\n";
  };
  for (const ImageScores& image : report.images) print_row(image.files.name, image.scores);
  print_row("mean", means);
}

Json report_json(const MetricTool& tool, const ToolReport& report) {
  const ToolScores means = mean_scores(report.images);
  Json json = {{"tool", tool.name()}};
  add_path(json, "prediction", report.prediction);
  add_path(json, "reference", report.reference);
  add_path(json, "mask", report.mask);
  add_path(json, "glass", report.glass);
  json["num_images"] = report.images.size();
  json["mean"] = scores_json(means);
  json["summary"] = tool.summary(report.images);
  json["protocol"] = Json::object();
  for (const auto& mean : means) {
    const std::string id = mean.first.substr(0, mean.first.find('@'));
    json["protocol"][id] = tool.protocol(id);
  }
  json["images"] = Json::array();
  for (const ImageScores& image : report.images) json["images"].push_back(image_json(image));
  json["missing"] = report.missing;
  return json;
}

void print_json(const MetricTool& tool, const ToolReport& report, std::ostream& out) {
  out << report_json(tool, report).dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
}

}  // namespace glint
