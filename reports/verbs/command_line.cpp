// SPDX-License-Identifier: MIT
#include "reports/verbs/command_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <new>

#include "glint/core/interrupt.h"
#include "glint/core/nearest.h"
#include "glint/core/parallel.h"
#include "glint/core/printable.h"
#include "glint/core/process.h"
#include "glint/core/progress.h"
#include "metrics/tools/numeric_options.h"
#include "reports/run/records/embedded.h"
#include "reports/run/records/environment.h"
#include "reports/run/records/revision.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

// Every verb takes every common option, so that one command line serves several verbs; its help
// shows those that it uses.
class CommonOptionAdder {
 public:
  CommonOptionAdder(CLI::App& verb, CommonOption uses) : verb_(verb), uses_(uses) {}

  template <class T>
  CLI::Option* option(CommonOption needed, const char* name, T& value, const std::string& help)
      const {
    return verb_.add_option(name, value, help)->group(group_of(needed));
  }
  void flag(CommonOption needed, const char* name, bool& value, const std::string& help) const {
    verb_.add_flag(name, value, help)->group(group_of(needed));
  }

 private:
  const char* group_of(CommonOption needed) const { return uses_ & needed ? "Common" : ""; }

  CLI::App& verb_;
  CommonOption uses_;
};

// Where results and data lie, and which cells: the options of a profile.
void add_profile_options(const CommonOptionAdder& add, CommonOptions& common) {
  const char* out = "results lie in OUT/PROFILE; that folder itself does, too";
  add.option(kOutOption, "--out", common.out, out)->capture_default_str();
  add.option(kDataOption, "--data", common.data, "scenes that were made or fetched")
      ->capture_default_str();
  const std::string profiles = comma_list(embedded_names("profiles")) + ", or a TOML file";
  add.option(kProfileOption, "--profile", common.profile, profiles)->capture_default_str();
  const char* methods =
      "globs of whole ids, a,b*,c (* also runs over /); also beyond the profile's";
  add.option(kCellOptions, "--methods", common.methods, methods)->delimiter(',');
  const char* only = "only cells whose scene/method/seed matches a glob: a,b*,c";
  add.option(kCellOptions, "--only", common.only, only)->delimiter(',');
  add.option(kCellOptions, "--skip", common.skip, "no cells that match a glob")->delimiter(',');
}

// How a method is trained.
void add_training_options(const CommonOptionAdder& add, CommonOptions& common) {
  add.option(kSeedOption, "--seed", common.seed, "one seed, a whole number");
  const char* iterations = "training steps; else as the profile says";
  add.option(kIterationsOption, "--iterations", common.iterations, iterations)->check(above_zero());
  const char* set =
      "config field: name=value or method.name=value (`glint-bench methods ID` lists them)";
  add.option(kSetOption, "--set", common.set, set);
  const char* checkpoint = "seconds between checkpoints, from which a stopped training goes on";
  add.option(kCheckpointOption, "--checkpoint-seconds", common.checkpoint_seconds, checkpoint)
      ->capture_default_str()
      ->check(at_least_zero());
  const char* test = "steps between looks at test views, for figures; 0: none";
  add.option(kCheckpointOption, "--test-psnr-every", common.test_psnr_every, test)
      ->check(at_least_zero());
}

void add_machine_options(const CommonOptionAdder& add, CommonOptions& common) {
  add.option(kDeviceOption, "--device", common.device, "auto, cpu or cuda")->capture_default_str();
  add.option(kThreadsOption, "--threads", common.threads, "0: all cores")->check(at_least_zero());
  add.flag(kJsonOption, "--json", common.json, "one JSON document on standard output");
  add.flag(kQuietOption, "--quiet", common.quiet, "no progress and no notes on standard error");
}

int report_error(const std::string& message, ExitCode code) {
  log::text(fmt::format("error: {}\n", printable(message)));
  return static_cast<int>(code);
}

std::vector<std::string> verbs_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!verb->get_group().empty()) names.push_back(verb->get_name());
  return names;
}

// Those that help shows, without their dashes.
std::vector<std::string> options_of(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    if (option->nonpositional() && !option->get_group().empty())
      names.push_back(option->get_name().substr(2));
  return names;
}

// What is wrong with the first word that no verb took; empty: every word was taken, something else
// is wrong. CLI11 looks for what is missing first and has no suggestions.
std::string unknown_word(const CLI::App& app) {
  const CLI::App* verb = &app;
  std::string name = app.get_name();
  while (!verb->get_subcommands().empty()) {
    verb = verb->get_subcommands().front();
    name += " " + verb->get_name();
  }
  const std::vector<std::string> left = app.remaining(true);
  if (left.empty()) return {};
  const std::string word = left.front().substr(0, left.front().find('='));
  const std::vector<std::string> verbs = verbs_of(*verb), options = options_of(*verb);
  if (!verbs.empty() && !word.starts_with("-"))
    return fmt::format(
        "{}: no verb '{}'; {}verbs: {}", name, word, did_you_mean(word, verbs), comma_list(verbs)
    );
  const std::string name_of_option =
      word.substr(std::min(word.find_first_not_of('-'), word.size()));
  return fmt::format(
      "{}: {} '{}'; {}options: {}",
      name,
      word.starts_with("-") ? "no option" : "no use for",
      word,
      did_you_mean(name_of_option, options),
      comma_list(options)
  );
}

// CLI11 prints help and messages; its own exit codes become ours.
int explain(const CLI::App& app, const CLI::ParseError& error) {
  const bool asked = error.get_exit_code() == 0;  // --help, --version
  const std::string unknown = asked ? "" : unknown_word(app);
  if (unknown.empty()) return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kUsage);
  return report_error(unknown, ExitCode::kUsage);
}

// Common options that a verb takes and does not use.
void warn_of_unused(const CLI::App& app) {
  for (const CLI::App* verb : app.get_subcommands()) {
    for (const CLI::Option* option : verb->get_options())
      if (option->get_group().empty() && option->count() > 0)
        log::warn(fmt::format(
            "{}: --{} changes nothing here", verb->get_name(), option->get_lnames().front()
        ));
    warn_of_unused(*verb);
  }
}

int parse_and_run(CommandLine& line, int argc, const char* const* argv) {
  try {
    line.app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return explain(line.app, error);
  }
  check_numbers(line.app);
  line.common.apply(line.uses);
  warn_of_unused(line.app);
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
  if (test_psnr_every) resolved.test_psnr_every = *test_psnr_every;
  return resolved;
}

void CommonOptions::apply(CommonOption uses) const {
  set_quiet(quiet);
  if (threads > 0) set_num_threads(threads);
  if ((uses & kDeviceOption) && !(uses & kDeviceLater))
    choose_device(device, (uses & kDeviceMatters) != 0);
}

CommandLine::CommandLine() {
  app.name("glint-bench");
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("glint-bench 0.1.0 ({})", git_revision()));
  for (const auto& [id, verb] : Registry<Verb>::all()) verb.add(*this);
}

CLI::App* CommandLine::add_verb(
    CLI::App& parent,
    const std::string& name,
    const std::string& help,
    Action run,
    CommonOption uses
) {
  CLI::App* verb = parent.add_subcommand(name, help);
  const CommonOptionAdder add(*verb, uses);
  add_profile_options(add, common);
  add_training_options(add, common);
  add_machine_options(add, common);
  verb->callback([this, uses, run = std::move(run)] {
    action = run;
    this->uses = uses;
  });
  return verb;
}

void describe_out(CLI::App& verb, const std::string& meaning) {
  verb.get_option("--out")->description(meaning)->default_str("");
}

int run_command_line(int argc, const char* const* argv) {
  ignore_file_size_signal();
  fill_standard_streams();
  CommandLine line;
  try {
    const int code = parse_and_run(line, argc, argv);
    std::cout.flush();  // what CLI11 prints
    GLINT_CHECK(std::cout.good() && std::fflush(stdout) == 0, kEnvironment, "{}", kNoOutput);
    return code;
  } catch (const Error& error) {
    return report_error(error.what(), error.code());
  } catch (const Interrupted&) {
    log::warn("interrupted: what was begun is not complete");
    return interrupted_exit();
  } catch (const std::exception& error) {
    const std::string message = out_of_memory_message(error).value_or(error.what());
    return report_error(message, ExitCode::kEnvironment);
  }
}

void print_json(const Json& json) {
  Json document = {{"schema", kVerbSchema}};
  document.update(json);
  print_raw(document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void print_text(std::string_view text) { print_raw(printable(text)); }

void print_result(const CommonOptions& common, const Json& json, std::string_view text) {
  if (common.json)
    print_json(json);
  else
    print_text(text);
}

void print_raw(std::string_view text) {
  // What is larger than the buffer is written at once: then there is nothing left to flush.
  const bool taken = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  GLINT_CHECK(std::fflush(stdout) == 0 && taken, kEnvironment, "{}", kNoOutput);
}

bool color_terminal() { return ::isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr; }

std::size_t terminal_width() {
  if (const char* columns = std::getenv("COLUMNS"))
    if (const long width = std::strtol(columns, nullptr, 10); width > 0)
      return static_cast<std::size_t>(width);
  winsize size{};
  return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

}  // namespace glint
