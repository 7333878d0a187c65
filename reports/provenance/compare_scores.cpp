// SPDX-License-Identifier: MIT
#include "reports/provenance/compare_scores.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "metrics/metric.h"
#include "reports/bench/mesh_eval.h"

namespace glint {
namespace {

// Of values that other kernels computed: networks on another CPU, anything on a GPU.
constexpr double kRounding = 1e-6;  // relative

// "psnr@glass" is psnr on a region; of meshes '@' belongs to the id.
std::string metric_of(const std::string& id) {
  const Metric* metric = find_metric(id);
  return metric ? metric->id : id.substr(0, id.find('@'));
}

bool has_files(const std::string& id) {
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics)
      if (metric.id == id) return family.files != nullptr;
  return false;
}

bool is_of_meshes(const std::string& id) {
  const auto& list = mesh_metric_list();
  return std::any_of(list.begin(), list.end(), [&](const Metric& m) { return m.id == id; });
}

// Values that nothing here can compute.
bool cannot_recompute(const std::string& id) {
  if (is_cost(id) || id == "num-surfels") return true;
  const std::string metric = metric_of(id);
  return find_metric(id) == nullptr || missing_metrics().contains(metric) ||
         (is_of_meshes(metric) && !score_meshes.here());
}

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

class ValueComparer {
 public:
  explicit ValueComparer(const ScoreRules& rules) : rules_(rules) {}

  ScoreComparison compare(const Json& then, const std::map<std::string, double>& now) {
    for (const auto& [id, value] : then.items()) {
      const auto found = now.find(id);
      if (found != now.end())
        compare_value(id, value, found->second);
      else if (cannot_recompute(id))
        result_.not_recomputed.push_back(id);
      else
        result_.differing.push_back(id + " cannot be computed any more");
    }
    for (const auto& [id, value] : now)
      if (!then.contains(id)) note_new(id, value);
    return std::move(result_);
  }

 private:
  void compare_value(const std::string& id, const Json& then, double now) {
    const bool both_infinite = then.is_null() && !std::isfinite(now);
    if (both_infinite || (then.is_number() && then.get<double>() == now)) {
      ++result_.equal;
      return;
    }
    const double value = then.is_number() ? then.get<double>() : 0;
    const double difference = std::abs(now - value);
    const bool may_round = !rules_.same_device || has_files(metric_of(id));
    if (then.is_number() && may_round && difference <= kRounding * std::abs(value))
      result_.rounded.push_back(fmt::format("{} {:.1g}", id, difference));
    else
      result_.differing.push_back(fmt::format("{} {}, now {}", id, then.dump(), Json(now).dump()));
  }

  // Of a metric that came later, or whose weights were missing then.
  void note_new(const std::string& id, double value) {
    const std::string metric = metric_of(id);
    const bool known = rules_.protocols.contains(metric) && !has_files(metric);
    if (known)
      result_.differing.push_back(fmt::format("{} was not there, now {}", id, value));
    else
      result_.added.push_back(id);
  }

  const ScoreRules& rules_;
  ScoreComparison result_;
};

Json values_of_view(const Json& metrics_file, const std::string& view) {
  for (const Json& entry : metrics_file.value("views", Json::array()))
    if (entry.is_object() && entry.value("name", "") == view)
      return entry.value("metrics", Json::object());
  return {};
}

}  // namespace

void ScoreComparison::add(const ScoreComparison& other) {
  equal += other.equal;
  append(rounded, other.rounded);
  append(differing, other.differing);
  append(not_recomputed, other.not_recomputed);
  append(added, other.added);
}

ScoreComparison compare_values(
    const Json& then, const std::map<std::string, double>& now, const ScoreRules& rules
) {
  return ValueComparer(rules).compare(then, now);
}

ScoreComparison compare_scores(
    const Json& metrics_file,
    const RunScores& now,
    const std::vector<View>& views,
    const ScoreRules& rules
) {
  ScoreComparison all =
      compare_values(metrics_file.value("metrics", Json::object()), now.means, rules);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Json then = values_of_view(metrics_file, views[i].name);
    if (then.is_object()) {
      ScoreComparison view = compare_values(then, now.views[i], rules);
      for (std::string& line : view.differing) line = views[i].name + ": " + line;
      view.not_recomputed.clear();  // the means say so
      view.added.clear();
      all.add(view);
    } else {
      all.differing.push_back(views[i].name + " has no values");
    }
  }
  const std::size_t listed = metrics_file.value("views", Json::array()).size();
  if (listed > views.size())
    all.differing.push_back(fmt::format("{} views, the data have {}", listed, views.size()));
  return all;
}

}  // namespace glint
