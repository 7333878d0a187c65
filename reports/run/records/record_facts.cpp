// SPDX-License-Identifier: MIT
#include "reports/run/records/record_facts.h"

namespace glint {

std::string environment_text(const Record& record, const char* field) {
  const Json& environment = record.environment;
  if (!environment.is_object() || !environment.contains(field)) return {};
  const Json& value = environment[field];
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string training_revision(const Record& record) {
  for (const std::string& warning : record.warnings)
    if (warning.starts_with(kTrainedBy)) return warning.substr(kTrainedBy.size());
  return environment_text(record, "git_revision");
}

std::string device_text(const Record& record) {
  const std::string device = environment_text(record, "device");
  const std::string cpu = environment_text(record, "cpu");
  return device != "cpu" || cpu.empty() ? device : cpu;
}

}  // namespace glint
