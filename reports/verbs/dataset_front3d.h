// SPDX-License-Identifier: MIT
// `dataset make front3d`: what only this generator is asked for.
#pragma once

#include "datasets/front3d/front3d.h"
#include "datasets/glassroom/glassroom.h"
#include "reports/verbs/verb.h"

namespace glint {

void add_front3d_options(CLI::App& make, Front3dOptions& options);

struct MadeScene {
  std::string name;
  fs::path folder;
  bool is_new = false;
};
// Sizes, views, samples, seed and priors are those of `room`.
MadeScene make_front3d_scene(
    const CommonOptions& common,
    Front3dOptions options,
    const GlassRoomOptions& room,
    bool out_given
);

}  // namespace glint
