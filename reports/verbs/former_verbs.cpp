// SPDX-License-Identifier: MIT
// Verbs that other verbs do now. `plan` and `run` work for one release; help shows none of them.
#include <memory>

#include "glint/core/progress.h"
#include "reports/verbs/run_options.h"
#include "reports/verbs/status_verb.h"

namespace glint {
namespace {

void tell(const std::string& former, const std::string& now) {
  log::warn(fmt::format("`{}` goes with the next release; use `glint-bench {}`", former, now));
}

void add_plan(CommandLine& line) {
  auto tasks = std::make_shared<bool>(false);
  CLI::App* verb = line.add_verb(
      line.app,
      "plan",
      "`status`",
      [&line, tasks] {
        tell("plan", *tasks ? "status --tasks" : "status");
        return print_status(line.common, *tasks);
      },
      kPlanOptions
  );
  verb->add_flag("--tasks", *tasks, "as of `status`");
  verb->group("");
}

void add_run(CommandLine& line) {
  auto how = std::make_shared<CellRunOptions>();
  how->no_tables = true;
  CLI::App* verb = line.add_verb(
      line.app,
      "run",
      "`all --no-tables`",
      [&line, how] {
        tell("run", how->data_only ? "all --data-only" : "all --no-tables");
        return run_all(line.common, *how);
      },
      kAllOptions | kDeviceLater
  );
  add_cell_run_options(*verb, *how);
  verb->group("");
}

// Its words are not looked at.
void add_gone(CommandLine& line, const char* name, const char* now) {
  CLI::App* verb = line.app.add_subcommand(name);
  verb->callback([&line, name, now] {
    line.action = [name, now]() -> int {
      throw Error(ExitCode::kUsage, fmt::format("`{}` is gone; use {}", name, now));
    };
  });
  verb->allow_extras()->prefix_command()->group("");
}

void add_former_verbs(CommandLine& line) {
  add_plan(line);
  add_run(line);
  add_gone(line, "clean", "`glint-bench status --leftovers`, with --yes to remove them");
  add_gone(
      line,
      "audit",
      "`glint-bench all` into two --out, with other --threads, and `glint-bench compare`; bytes: "
      "sha256 in RUN/keys/*.json"
  );
}

}  // namespace

GLINT_REGISTER(Verb, {"former verbs", add_former_verbs})

}  // namespace glint
