// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/progress.h"
#include "reports/records/leftovers.h"
#include "reports/verbs/listing.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

struct CleanOptions {
  bool remove = false, unfinished = false;
};

std::string size_text(std::uintmax_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

Json clean_json(const std::vector<Leftover>& leftovers, bool removed) {
  Json json = {{"removed", removed}, {"leftovers", Json::array()}};
  for (const Leftover& leftover : leftovers)
    json["leftovers"].push_back(
        {{"path", leftover.path.string()}, {"why", leftover.why}, {"bytes", leftover.bytes}}
    );
  return json;
}

std::string clean_text(const std::vector<Leftover>& leftovers, bool removed) {
  if (leftovers.empty()) return "nothing is left over\n";
  std::vector<std::vector<std::string>> rows;
  std::uintmax_t bytes = 0;
  for (const Leftover& leftover : leftovers) {
    rows.push_back({leftover.path.string(), size_text(leftover.bytes), leftover.why});
    bytes += leftover.bytes;
  }
  return listing(rows) + fmt::format(
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
  if (common.json)
    print_json(clean_json(leftovers, options.remove));
  else
    print_text(clean_text(leftovers, options.remove));
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
