// SPDX-License-Identifier: MIT
#include "reports/show/tables/method_title.h"

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

bool is_rival(const std::string& id) {
  const auto method = Registry<MethodSpec>::all().find(id);
  return method == Registry<MethodSpec>::all().end() || method->second.rival;
}

}  // namespace glint
