// SPDX-License-Identifier: MIT
// scene.json: what a folder says of itself besides its cameras. GlassRoom's generator and
// `dataset export` write it; folders by others have none.
#pragma once

#include "datasets/scene_index.h"

namespace glint {

// Name, dataset, hash and whether priors are simulated go into the index; with "side_maps", the
// maps of side_maps.h that are there go to the views; "test_views" (names) replaces the split;
// "alpha" (black, white, mask, stored) says what is made of that channel of pictures; views of
// "without_priors" (names) may lack files of priors; "prior_folder", "prior_axes",
// "prior_depth", "prior_overlap" and "albedo_from_basecolor" go into stated_priors. Without the
// file nothing happens. Errors (kBadReference): no JSON object; names of no view.
void read_scene_json(const fs::path& folder, SceneIndex& index);

// What is made of alpha, of all views; `where` opens the message. Errors (kBadReference): no such
// use.
void set_alpha_use(const std::string& use, const std::string& where, SceneIndex& index);

}  // namespace glint
