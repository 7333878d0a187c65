// SPDX-License-Identifier: MIT
#include "reports/show/figures/figure_methods.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "glint/method.h"
#include "reports/show/tables/main_methods.h"
#include "reports/show/tables/tables.h"

namespace glint {

namespace {

// Of one of our methods; a slash in an import's name says nothing.
bool is_variant(const std::string& id) {
  const std::size_t slash = id.find('/');
  return slash != std::string::npos && Registry<MethodSpec>::all().contains(id.substr(0, slash));
}

bool any_matches(const std::vector<std::string>& globs, const std::string& id) {
  return std::any_of(globs.begin(), globs.end(), [&](const std::string& glob) {
    return glob_match(glob, id);
  });
}

std::set<std::string> ablation_variants() {
  std::set<std::string> ids;
  for (const TableDefinition& definition : table_definitions())
    if (definition.paper_table == "3")
      for (const TableRowDefinition& row : definition.rows)
        if (is_variant(row.method)) ids.insert(row.method);
  return ids;
}

// Place in the summary; behind all others where it has no row of its own.
std::size_t row_of(const std::string& id) {
  static const std::vector<TableRowDefinition> rows = table_definition("summary").rows;
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const TableRowDefinition& candidate) {
    return candidate.method == id;
  });
  return static_cast<std::size_t>(row - rows.begin());
}

}  // namespace

bool InTableOrder::operator()(const std::string& a, const std::string& b) const {
  return std::pair(row_of(a), a) < std::pair(row_of(b), b);
}

bool MethodChoice::in_pictures(const std::string& id) const {
  return globs.empty() ? !is_variant(id) || is_main_method(id) : any_matches(globs, id);
}

bool MethodChoice::in_curves(const std::string& id) const {
  static const std::set<std::string> ablations = ablation_variants();
  return globs.empty() ? !ablations.contains(id) : any_matches(globs, id);
}

bool MethodChoice::in_studies(const std::string& id) const {
  return globs.empty() || any_matches(globs, id);
}

std::vector<std::string> figure_methods(const std::vector<Record>& records) {
  std::set<std::pair<bool, std::string>> methods;
  for (const Record& record : records)
    if (record.ok()) methods.emplace(is_variant(record.cell.method), record.cell.method);
  std::vector<std::string> ids;
  for (const auto& [variant, id] : methods) ids.push_back(id);
  return ids;
}

std::size_t ChartMethods::index_of(const std::string& id) const {
  return static_cast<std::size_t>(std::find(ids_.begin(), ids_.end(), id) - ids_.begin());
}

std::vector<std::string> ChartMethods::titles() const {
  std::vector<std::string> titles;
  for (const std::string& id : ids_) titles.push_back(method_title(id));
  return titles;
}

double metric_of(const Record& record, const std::string& id) {
  const auto it = record.metrics.find(id);
  return it == record.metrics.end() ? std::nan("") : it->second;
}

}  // namespace glint
