// SPDX-License-Identifier: MIT
#include "reports/run/provenance/compare_scores.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "metrics/metric.h"
#include "reports/run/bench/mesh_eval.h"

namespace glint {
namespace {

// Relative: values of networks on another CPU and of anything on a GPU, which other kernels
// computed.
constexpr double kRounding = 1e-6;
constexpr std::string_view kOfView = ": ";  // between a view's name and an id

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

// Value by "psnr", of views "0001: psnr"; null where it was not finite.
using Values = std::map<std::string, Json>;

void add_values(const Json& list, const std::string& prefix, Values& values) {
  const Json metrics = list.value("metrics", Json::object());
  for (const auto& [id, value] : metrics.items()) values[prefix + id] = value;
}

Values values_of(const Json& metrics_file) {
  Values values;
  add_values(metrics_file, "", values);
  for (const Json& view : metrics_file.value("views", Json::array()))
    if (view.is_object()) add_values(view, view.value("name", "") + std::string(kOfView), values);
  return values;
}

class ScoreComparer {
 public:
  ScoreComparer(const Json& then, const Json& now)
      : then_(values_of(then)),
        now_(values_of(parse_json(now.dump()))),  // as a file has what is not finite
        protocols_(then.value("protocol", Json::object())) {}

  ScoreComparison compare() {
    for (const auto& [name, value] : then_)
      if (const auto found = now_.find(name); found != now_.end())
        compare_value(name, value, found->second);
      else if (!cannot_recompute(id_of(name)))
        result_.differing.push_back(name + " cannot be computed any more");
      else if (is_mean(name))
        result_.not_recomputed.push_back(name);
    for (const auto& [name, value] : now_)
      if (!then_.contains(name)) note_new(name, value);
    return std::move(result_);
  }

 private:
  static bool is_mean(const std::string& name) { return name.find(kOfView) == std::string::npos; }
  static std::string id_of(const std::string& name) {
    return is_mean(name) ? name : name.substr(name.rfind(kOfView) + kOfView.size());
  }

  void compare_value(const std::string& name, const Json& then, const Json& now) {
    if (then == now) {
      ++result_.equal;
      return;
    }
    const bool numbers = then.is_number() && now.is_number();
    const double value = numbers ? then.get<double>() : 0,
                 difference = numbers ? std::abs(now.get<double>() - value) : 1;
    if (difference <= kRounding * std::abs(value))
      result_.rounded.push_back(fmt::format("{} {:.1g}", name, difference));
    else
      result_.differing.push_back(fmt::format("{} {}, now {}", name, then.dump(), now.dump()));
  }

  // Of a metric that came later, or whose weights were missing then.
  void note_new(const std::string& name, const Json& value) {
    const std::string metric = metric_of(id_of(name));
    if (protocols_.contains(metric) && !has_files(metric))
      result_.differing.push_back(fmt::format("{} was not there, now {}", name, value.dump()));
    else if (is_mean(name))
      result_.added.push_back(name);
  }

  Values then_, now_;
  Json protocols_;
  ScoreComparison result_;
};

}  // namespace

ScoreComparison compare_scores(const Json& then, const Json& now) {
  return ScoreComparer(then, now).compare();
}

}  // namespace glint
