// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "reports/records/leftovers.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

struct CleanOptions {
  bool remove = false, unfinished = false;
};

std::string size_text(std::uintmax_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

Rows rows_of(const std::vector<Leftover>& leftovers) {
  Rows rows({{"path"}, {"bytes"}, {"why"}});
  for (const Leftover& leftover : leftovers)
    rows.add({leftover.path.string(), {leftover.bytes, size_text(leftover.bytes)}, leftover.why});
  return rows;
}

std::string clean_text(const std::vector<Leftover>& leftovers, bool removed) {
  if (leftovers.empty()) return "nothing is left over\n";
  std::uintmax_t bytes = 0;
  for (const Leftover& leftover : leftovers) bytes += leftover.bytes;
  return rows_of(leftovers).text() +
         fmt::format(
             "{} in all, {}\n",
             size_text(bytes),
             removed ? "removed" : "nothing was removed: that takes --yes"
         );
}

int run_clean(const CommonOptions& common, const CleanOptions& options) {
  const fs::path folder = profile_folder(common.out, load_profile(common.profile).name);
  const auto leftovers = find_leftovers(folder, options.unfinished);
  if (options.remove)
    for (const Leftover& leftover : leftovers) remove_leftover(leftover);
  print_result(
      common,
      {{"removed", options.remove}, {"leftovers", rows_of(leftovers).json()}},
      clean_text(leftovers, options.remove)
  );
  return 0;
}

void add_clean_verb(CommandLine& line) {
  auto options = std::make_shared<CleanOptions>();
  CLI::App* verb = line.add_verb(
      line.app,
      "clean",
      "list what belongs to no finished cell of a profile, and remove it",
      [&line, options] { return run_clean(line.common, *options); },
      kOutOption | kProfileOption | kJsonOption | kQuietOption
  );
  verb->add_flag("--yes", options->remove, "remove what is listed");
  verb->add_flag(
      "--unfinished",
      options->unfinished,
      "also trainings that `all` would go on with, and runs of failed cells"
  );
}

}  // namespace

GLINT_REGISTER(Verb, {"clean", add_clean_verb})

}  // namespace glint
