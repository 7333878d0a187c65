// SPDX-License-Identifier: MIT
// What stands below the verb `dataset`, each in a file dataset_*.cpp.
#pragma once

#include <optional>
#include <string>

#include "datasets/front3d/front3d.h"
#include "datasets/glassroom/glassroom.h"
#include "reports/verbs/verb.h"

namespace glint {

void add_dataset_export(CommandLine& line, CLI::App& dataset);
void add_dataset_import(CommandLine& line, CLI::App& dataset);
void add_dataset_holdout(CommandLine& line, CLI::App& dataset);

// `dataset info` and `check` of a published dataset: by its id (below --data), or by the folder of
// that name. The exit code; nothing: `name` is no published dataset.
std::optional<int> show_manifest(const CommonOptions& common, const std::string& name);
// Missing scenes and scenes that are not as published are findings: exit code 4.
std::optional<int> check_manifest(const CommonOptions& common, const std::string& name);

// `dataset make front3d`: what only this generator is asked for.
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
