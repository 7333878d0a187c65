// SPDX-License-Identifier: MIT
// Verbs of glint-bench. Each file adds one to the command line; the chosen one leaves its action.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "reports/bench/plan.h"
#include "reports/records/scene_source.h"
#include "reports/tables/table_writers.h"

namespace glint {

// Options that every verb has; those a verb has no use for do nothing.
struct CommonOptions {
  std::string out = "out";    // results in OUT/PROFILE
  std::string data = "data";  // made and imported scenes
  std::string profile = "ci";
  std::vector<std::string> only, skip, set;
  std::optional<std::uint64_t> seed;
  int iterations = 0;  // 0: as the profile says
  std::string device = "auto";
  int threads = 0;  // 0: all cores
  bool json = false, quiet = false;

  fs::path profile_folder(const Profile& p) const { return fs::path(out) / p.name; }
  fs::path records_file(const Profile& p) const { return profile_folder(p) / "records.jsonl"; }
  CellFilter filter() const { return {only, skip}; }
  SceneLoader scene_loader() const;
  SceneIdentifier scene_identifier() const;
  // The profile with --seed and --iterations applied.
  Profile resolved_profile() const;
  // --threads, --quiet and --device take effect. Errors: as choose_device.
  void apply() const;
};

// What main() runs after parsing; returns the exit code.
using Action = std::function<int()>;

struct CommandLine {
  CLI::App app{"GLINT Bench: trains and scores reconstructions of scenes with glass"};
  CommonOptions common;
  Action action;

  CommandLine();
  // A verb with the common options; `run` becomes the action when the verb was chosen.
  CLI::App* add_verb(
      CLI::App& parent, const std::string& name, const std::string& help, Action run
  );
};

void add_all_verb(CommandLine& line);
void add_plan_verb(CommandLine& line);
void add_status_verb(CommandLine& line);
void add_dataset_verb(CommandLine& line);
void add_train_verb(CommandLine& line);
void add_render_verb(CommandLine& line);
void add_eval_verb(CommandLine& line);
void add_mesh_verb(CommandLine& line);
void add_results_verb(CommandLine& line);
void add_selftest_verb(CommandLine& line);
void add_table_verb(CommandLine& line);
void add_report_verb(CommandLine& line);
void add_compare_verb(CommandLine& line);
void add_figures_verb(CommandLine& line);
void add_perf_verb(CommandLine& line);
void add_doctor_verb(CommandLine& line);

// Parses, runs and reports errors on standard error: the whole of main().
int run_command_line(int argc, const char* const* argv);

// Results go here: one JSON document, or text.
void print_json(const Json& json);
void print_text(std::string_view text);
bool color_terminal();  // standard output is a terminal and NO_COLOR is not set

}  // namespace glint
