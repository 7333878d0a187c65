// SPDX-License-Identifier: MIT
#include "reports/verbs/command_line.h"

#include <unistd.h>

#include <cstdlib>
#include <new>

#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "reports/records/environment.h"
#include "reports/records/revision.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

void add_common_options(CLI::App& verb, CommonOptions& common) {
  const char* group = "Common";
  verb.add_option("--out", common.out, "results lie in OUT/PROFILE; that folder itself does, too")
      ->capture_default_str()
      ->group(group);
  verb.add_option("--data", common.data, "scenes that were made or fetched")
      ->capture_default_str()
      ->group(group);
  verb.add_option("--profile", common.profile, "smoke, ci, small, paper, or a TOML file")
      ->capture_default_str()
      ->group(group);
  verb.add_option("--methods", common.methods, "globs of methods, a,b,c; also beyond the profile's")
      ->delimiter(',')
      ->group(group);
  verb.add_option("--only", common.only, "only cells whose scene/method/seed matches a glob")
      ->group(group);
  verb.add_option("--skip", common.skip, "no cells that match a glob")->group(group);
  verb.add_option("--seed", common.seed, "one seed in place of the profile's")->group(group);
  verb.add_option("--iterations", common.iterations, "training steps in place of the profile's")
      ->check(CLI::PositiveNumber)
      ->group(group);
  verb.add_option("--set", common.set, "config field: name=value or method.name=value")
      ->group(group);
  verb.add_option("--device", common.device, "auto, cpu or cuda")
      ->capture_default_str()
      ->group(group);
  verb.add_option("--threads", common.threads, "0: all cores")
      ->check(CLI::NonNegativeNumber)
      ->group(group);
  verb.add_flag("--json", common.json, "one JSON document on standard output")->group(group);
  verb.add_flag("--quiet", common.quiet, "no progress and no notes on standard error")
      ->group(group);
}

int report_error(const std::string& message, ExitCode code) {
  fmt::print(stderr, "error: {}\n", message);
  return static_cast<int>(code);
}

int parse_and_run(CommandLine& line, int argc, const char* const* argv) {
  try {
    line.app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 prints help and messages; its own codes become ours.
    return line.app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kUsage);
  }
  line.common.apply();
  return line.action();
}

}  // namespace

SceneLoader CommonOptions::scene_loader() const {
  return
      [folder = fs::path(data)](const SceneSource& source) { return load_source(source, folder); };
}

SceneIdentifier CommonOptions::scene_identifier() const {
  return [folder = fs::path(data)](const SceneSource& source) {
    return identify_source(source, folder);
  };
}

Profile CommonOptions::resolved_profile() const {
  Profile resolved = load_profile(profile);
  if (seed) resolved.seeds = {*seed};
  if (iterations > 0) resolved.iterations = iterations;
  return resolved;
}

void CommonOptions::apply() const {
  set_quiet(quiet);
  if (threads > 0) set_num_threads(threads);
  choose_device(device);
}

CommandLine::CommandLine() {
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("glint-bench 0.1.0 ({})", git_revision()));
  for (const auto& [id, verb] : Registry<Verb>::all()) verb.add(*this);
}

CLI::App* CommandLine::add_verb(
    CLI::App& parent, const std::string& name, const std::string& help, Action run
) {
  CLI::App* verb = parent.add_subcommand(name, help);
  add_common_options(*verb, common);
  verb->callback([this, run = std::move(run)] { action = run; });
  return verb;
}

int run_command_line(int argc, const char* const* argv) {
  CommandLine line;
  try {
    return parse_and_run(line, argc, argv);
  } catch (const Error& error) {
    return report_error(error.what(), error.code());
  } catch (const std::bad_alloc&) {
    return report_error(
        "out of memory; use smaller images or fewer threads", ExitCode::kEnvironment
    );
  } catch (const std::exception& error) {
    return report_error(error.what(), ExitCode::kEnvironment);
  }
}

void print_json(const Json& json) {
  print_text(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void print_text(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  GLINT_CHECK(std::fflush(stdout) == 0, kEnvironment, "standard output cannot be written");
}

bool color_terminal() { return ::isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr; }

}  // namespace glint
