// SPDX-License-Identifier: MIT
// `dataset make front3d`: what only this generator is asked for.
#pragma once

#include "datasets/front3d/front3d.h"
#include "datasets/glassroom/glassroom.h"
#include "reports/verbs/verb.h"

namespace glint {

void add_front3d_options(CLI::App& make, Front3dOptions& options);

// Errors (kUsage): one of them is given, which GlassRoom would not look at.
void check_no_front3d_options(const Front3dOptions& options);

// The options with the sizes, views, samples, seed and priors of `room`.
Front3dOptions front3d_shots(Front3dOptions options, const GlassRoomOptions& room);

struct MadeScene {
  std::string name;
  fs::path folder;
  bool is_new = false;
};
MadeScene make_front3d_scene(
    const CommonOptions& common,
    Front3dOptions options,
    const GlassRoomOptions& room,
    bool out_given
);

}  // namespace glint
