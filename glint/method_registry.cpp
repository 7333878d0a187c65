// SPDX-License-Identifier: MIT
#include "glint/core/nearest.h"
#include "glint/method.h"
#include "glint/setting_ranges.h"

namespace glint {

const MethodSpec& find_method(const std::string& id) {
  const auto& methods = Registry<MethodSpec>::all();
  if (const auto found = methods.find(id); found != methods.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, spec] : methods) known.push_back(name);
  throw Error(
      ExitCode::kUsage,
      fmt::format(
          "no method '{}'; {}known methods: {}",
          id,
          did_you_mean(id, known),
          known.empty() ? "none" : comma_list(known)
      )
  );
}

std::vector<ConfigField> Method::fields() const {
  std::vector<ConfigField> fields;
  const Json config = this->config();
  for (const auto& [name, value] : config.items()) fields.push_back({name, value, ""});
  return fields;
}

std::unique_ptr<Method> create_method(const std::string& id, const Json& config) {
  const MethodSpec& spec = find_method(id);
  Json merged = spec.overrides;
  merged.update(config);
  check_settings(id, merged);  // what is given, before anything is made of it
  auto method = spec.create(merged);
  check_settings(id, method->config());
  return method;
}

}  // namespace glint
