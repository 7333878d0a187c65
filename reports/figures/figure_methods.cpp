// SPDX-License-Identifier: MIT
#include "reports/figures/figure_methods.h"

#include <set>

#include "glint/method.h"

namespace glint {

std::string method_title(const std::string& id) {
  const auto& registry = Registry<MethodSpec>::all();
  const auto method = registry.find(id);
  if (method == registry.end()) return id;
  const std::string& title = method->second.title;
  const auto base = registry.find(id.substr(0, id.find('/')));
  if (base == registry.end() || title.starts_with(base->second.title)) return title;
  return base->second.title + ", " + title;
}

std::vector<std::string> figure_methods(const std::vector<Record>& records) {
  std::set<std::pair<bool, std::string>> methods;
  for (const Record& record : records)
    if (record.ok())
      methods.emplace(record.cell.method.find('/') != std::string::npos, record.cell.method);
  std::vector<std::string> ids;
  for (const auto& [variant, id] : methods) ids.push_back(id);
  return ids;
}

}  // namespace glint
