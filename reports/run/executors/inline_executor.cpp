// SPDX-License-Identifier: MIT
#include "reports/run/executors/executor.h"

namespace glint {
namespace {

RunSummary run_inline(const RunnerOptions& options, const ExecutorOptions& how) {
  GLINT_CHECK(
      how.jobs == 1 && how.time_limit == 0 && how.time_for_all == 0 && !how.order,
      kUsage,
      "--executor inline: --jobs, --time-limit, --for and --order need processes; take --executor "
      "local"
  );
  RunnerOptions limited = options;
  limited.max_failures = how.max_failures;
  return run_profile(limited);
}

}  // namespace

GLINT_REGISTER(Executor, {"inline", "all cells in this process, one scene loaded once", run_inline})

}  // namespace glint
