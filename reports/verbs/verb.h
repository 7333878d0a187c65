// SPDX-License-Identifier: MIT
// Verbs of glint-bench. Each file adds one to the command line; the chosen one leaves its action.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/registry.h"
#include "reports/run/bench/plan.h"
#include "reports/run/records/profile_folder.h"
#include "reports/run/records/scene_source.h"
#include "reports/show/tables/table_writers.h"

namespace glint {

// Options that several verbs have; each verb says which of them it uses.
enum CommonOption : unsigned {
  kOutOption = 1u << 0,
  kDataOption = 1u << 1,
  kProfileOption = 1u << 2,
  kCellOptions = 1u << 3,  // --methods, --only, --skip
  kSeedOption = 1u << 4,
  kIterationsOption = 1u << 5,
  kSetOption = 1u << 6,
  kDeviceOption = 1u << 7,
  kThreadsOption = 1u << 8,
  kJsonOption = 1u << 9,
  kQuietOption = 1u << 10,
  kDeviceMatters = 1u << 11,     // says why it runs on the CPU where --device is auto
  kCheckpointOption = 1u << 12,  // verbs that train
  kDeviceLater = 1u << 13,       // the verb takes the device itself, if it does
  // The cells of a profile, as `all` runs them.
  kPlanOptions = kOutOption | kDataOption | kProfileOption | kCellOptions | kSeedOption |
                 kIterationsOption | kSetOption | kDeviceOption | kJsonOption | kQuietOption,
  // Work that takes a while: methods and networks run.
  kWorkOptions = kDeviceOption | kDeviceMatters | kThreadsOption | kJsonOption | kQuietOption,
  // What reads a profile's folder.
  kFolderOptions = kOutOption | kProfileOption | kCellOptions | kJsonOption | kQuietOption,
  kAllOptions = kPlanOptions | kWorkOptions | kCheckpointOption
};
// Sets of them.
constexpr CommonOption operator|(CommonOption a, CommonOption b) {
  return static_cast<CommonOption>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}

struct CommonOptions {
  std::string out = "out";    // results in OUT/PROFILE (profile_folder.h)
  std::string data = "data";  // made and imported scenes
  std::string profile = "ci";
  std::vector<std::string> methods, only, skip, set;
  std::optional<std::uint64_t> seed;
  int iterations = 0;  // 0: as the profile says
  std::string device = "auto";
  int threads = 0;  // 0: all cores
  double checkpoint_seconds = 300;
  std::optional<int> test_psnr_every;  // else as the profile says
  bool json = false, quiet = false;

  fs::path own_folder(const Profile& p) const { return own_profile_folder(out, p.name); }
  fs::path records_file(const Profile& p) const { return own_folder(p) / "records.jsonl"; }
  CellFilter filter() const { return {only, skip, methods}; }
  SceneLoader scene_loader() const;
  SceneIdentifier scene_identifier() const;
  // The profile with --seed, --iterations and --test-psnr-every applied.
  Profile resolved_profile() const;
  // --threads, --quiet and, of verbs that have it, --device take effect. Errors: as choose_device.
  void apply(CommonOption uses) const;
};

// What main() runs after parsing; returns the exit code.
using Action = std::function<int()>;

struct CommandLine {
  CLI::App app{"GLINT Bench: trains and scores reconstructions of scenes with glass"};
  CommonOptions common;
  Action action;

  CommonOption uses{};  // of the chosen verb

  CommandLine();
  // A verb with those of the common options that it uses; `run` becomes the action when the verb
  // was chosen.
  CLI::App* add_verb(
      CLI::App& parent,
      const std::string& name,
      const std::string& help,
      Action run,
      CommonOption uses = kAllOptions
  );
};

// Help of --out for a verb whose results lie in no profile's folder.
void describe_out(CLI::App& verb, const std::string& meaning);

// Registered with GLINT_REGISTER(Verb, {"status", add_status_verb}); help lists them by id.
struct Verb {
  std::string id;
  void (*add)(CommandLine& line);
};

// Of the JSON that verbs print (docs/reference/verbs.md); grows when a field changes its meaning or
// goes.
inline constexpr int kVerbSchema = 1;

// Results go here: one JSON document, or text. Documents open with "schema".
void print_json(const Json& json);
void print_text(std::string_view text);  // names in it are made printable
// One of the two, as --json says.
void print_result(const CommonOptions& common, const Json& json, std::string_view text);
void print_raw(std::string_view text);  // with colours, or a file of some format
bool color_terminal();                  // standard output is a terminal and NO_COLOR is not set
// COLUMNS, or what the terminal says; 0 where standard output is none.
std::size_t terminal_width();

}  // namespace glint
