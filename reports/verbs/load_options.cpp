// SPDX-License-Identifier: MIT
#include "reports/verbs/load_options.h"

#include <fmt/ranges.h>

namespace glint {

void add_load_options(CLI::App& verb, LoadOptions& load) {
  verb.add_option("--loader", load.loader, "loader that reads it, by id; empty: the surest");
  verb.add_option(
          "--background",
          load.background,
          "what pictures with alpha lie on: black, white, mask (transparent pixels do not count) "
          "or "
          "stored; else as scene.json says"
  )
      ->check(CLI::IsMember({"black", "white", "mask", "stored"}));
  PriorOptions& priors = load.priors;
  verb.add_option("--priors", priors.folder, "folder with priors as other programs write them");
  verb.add_option(
      "--prior-axes",
      priors.axes,
      "of stored normals: auto, " + fmt::format("{}", fmt::join(kPriorAxes, ", "))
  );
  verb.add_option(
      "--prior-depth",
      priors.depth,
      "what depth priors count: auto, " + fmt::format("{}", fmt::join(kPriorDepths, ", "))
  );
  verb.add_option(
      "--prior-overlap", priors.overlap, "frames that two chunks share; else told from the files"
  );
  verb.add_flag(
      "--albedo-from-basecolor",
      priors.albedo_from_basecolor,
      "base colour x (1 - metallic) where there is no albedo"
  );
}

}  // namespace glint
