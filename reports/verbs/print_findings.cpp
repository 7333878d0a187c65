// SPDX-License-Identifier: MIT
#include "reports/verbs/print_findings.h"

#include <map>
#include <utility>

#include "glint/core/utf8.h"

namespace glint {

Json findings_json(const std::vector<Finding>& findings) {
  Json json = Json::array();
  for (const Finding& finding : findings)
    json.push_back(
        {{"check", finding.check},
         {"where", as_utf8(finding.where)},
         {"message", as_utf8(finding.message)}}
    );
  return json;
}

std::string findings_text(const std::vector<Finding>& findings) {
  constexpr std::size_t kMostAlike = 3;
  const auto key = [](const Finding& finding) { return std::pair(finding.check, finding.message); };
  std::map<std::pair<std::string, std::string>, std::size_t> counts, told;
  for (const Finding& finding : findings) ++counts[key(finding)];
  std::string text;
  for (const Finding& finding : findings) {
    const std::size_t number = ++told[key(finding)], count = counts[key(finding)];
    if (number > kMostAlike) continue;
    text += as_utf8(fmt::format("{}: {}: {}", finding.check, finding.where, finding.message));
    if (number == kMostAlike && count > kMostAlike)
      text += fmt::format(" (and {} more; --json names all)", count - kMostAlike);
    text += "\n";
  }
  return text;
}

int print_findings(
    const CommonOptions& common,
    const std::string& what,
    const std::vector<Finding>& findings,
    const std::string& when_none
) {
  print_result(
      common,
      {{"folder", as_utf8(what)}, {"findings", findings_json(findings)}},
      findings.empty() ? fmt::format("{}: {}\n", what, when_none) : findings_text(findings)
  );
  return static_cast<int>(findings.empty() ? ExitCode::kSuccess : ExitCode::kCheckFailed);
}

}  // namespace glint
