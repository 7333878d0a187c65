// SPDX-License-Identifier: MIT
// A scene whose truth is kept back: one folder for everybody, with which methods train and render
// the test views, and one for whoever scores the renders. Both put together are the scene again.
#pragma once

#include <string>

#include "glint/core/files.h"
#include "glint/scene/scene.h"

namespace glint {

struct HoldoutOptions {
  fs::path scene;     // a folder of the loader `easyvolcap`: what `dataset make` and exports write
  fs::path for_all;   // photos and priors of training views, cameras of all, points
  fs::path to_score;  // photos and priors of test views, all ground truth, scene.json
};

struct HoldoutReport {
  std::size_t files_for_all = 0, files_to_score = 0, test_views = 0;
  std::string warning;  // how the truth might be guessed all the same; empty: not known
};

// Fills both folders, which are not there or empty. In place of each test view's photo everybody
// gets a grey picture of its size, so that loaders, of other programs too, find a picture for each
// camera. What is not known to be harmless is kept back: only scene.json's name, dataset, units and
// how priors were made are told. Errors (kUsage): a folder that is not empty, or one inside of
// another; a scene of another layout, without test views, or whose truth is kept back already;
// kBadReference: files that the layout needs are missing; kEnvironment: cannot be written.
HoldoutReport hold_out_truth(const HoldoutOptions& options);

// Are the photos of its test views kept back? By scene.json of a folder; of packed scenes by their
// notes, so that it is asked of what was loaded, too.
bool is_held_out(const fs::path& folder);
bool is_held_out(const Scene& scene);

// What people are told of such a scene, in data_notes.
inline constexpr const char* kHeldOutNote =
    "photos and ground truth of its test views are kept back, grey pictures stand in for them: "
    "methods train on it and render the test views, and whoever has the truth scores them "
    "(docs/guide/submit.md)";

// Adds the note where the folder says that it is so.
void note_held_out(const fs::path& folder, Scene& scene);

// Errors (kBadReference): the scene is such a one, so that nothing can be scored against it.
void check_not_held_out(const fs::path& folder, const Scene& scene);

}  // namespace glint
