// SPDX-License-Identifier: MIT
// Verbs of glint-bench. Each file adds one to the command line; the chosen one leaves its action.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/registry.h"
#include "reports/bench/plan.h"
#include "reports/records/profile_folder.h"
#include "reports/records/scene_source.h"
#include "reports/tables/table_writers.h"

namespace glint {

// Options that every verb has; those a verb has no use for do nothing.
struct CommonOptions {
  std::string out = "out";    // results in OUT/PROFILE (profile_folder.h)
  std::string data = "data";  // made and imported scenes
  std::string profile = "ci";
  std::vector<std::string> methods, only, skip, set;
  std::optional<std::uint64_t> seed;
  int iterations = 0;  // 0: as the profile says
  std::string device = "auto";
  int threads = 0;  // 0: all cores
  bool json = false, quiet = false;

  fs::path own_folder(const Profile& p) const { return own_profile_folder(out, p.name); }
  fs::path records_file(const Profile& p) const { return own_folder(p) / "records.jsonl"; }
  CellFilter filter() const { return {only, skip, methods}; }
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

// Registered with GLINT_REGISTER(Verb, {"plan", add_plan_verb}); help lists them by id.
struct Verb {
  std::string id;
  void (*add)(CommandLine& line);
};

// Results go here: one JSON document, or text.
void print_json(const Json& json);
void print_text(std::string_view text);
bool color_terminal();  // standard output is a terminal and NO_COLOR is not set

}  // namespace glint
