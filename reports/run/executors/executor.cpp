// SPDX-License-Identifier: MIT
#include "reports/run/executors/executor.h"

#include "glint/core/nearest.h"

namespace glint {

const Executor& find_executor(const std::string& id) {
  std::vector<std::string> known;
  for (const auto& [name, executor] : Registry<Executor>::all()) known.push_back(name);
  const auto found = Registry<Executor>::all().find(id);
  GLINT_CHECK(
      found != Registry<Executor>::all().end(),
      kUsage,
      "--executor {}: no such executor; {}executors: {}",
      id,
      did_you_mean(id, known),
      comma_list(known)
  );
  return found->second;
}

}  // namespace glint
