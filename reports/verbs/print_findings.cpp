// SPDX-License-Identifier: MIT
#include "reports/verbs/print_findings.h"

namespace glint {

Json findings_json(const std::vector<Finding>& findings) {
  Json json = Json::array();
  for (const Finding& finding : findings)
    json.push_back(
        {{"check", finding.check}, {"where", finding.where}, {"message", finding.message}}
    );
  return json;
}

std::string findings_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings)
    text += fmt::format("{}: {}: {}\n", finding.check, finding.where, finding.message);
  return text;
}

int print_findings(
    const CommonOptions& common,
    const std::string& what,
    const std::vector<Finding>& findings,
    const std::string& when_none
) {
  if (common.json)
    print_json({{"folder", what}, {"findings", findings_json(findings)}});
  else
    print_text(
        findings.empty() ? fmt::format("{}: {}\n", what, when_none) : findings_text(findings)
    );
  return static_cast<int>(findings.empty() ? ExitCode::kSuccess : ExitCode::kCheckFailed);
}

}  // namespace glint
