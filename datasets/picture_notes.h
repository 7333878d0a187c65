// SPDX-License-Identifier: MIT
// What pictures are beside what their cameras and masks say of them: of another size, turned by
// EXIF, with a channel that is not read.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "datasets/scene_index.h"

namespace glint {

// `stored`: sizes of the views' pictures as they lie in their files, in the order of index.views;
// {0, 0}: not read.

// Where scaling intrinsics to the picture is likely wrong: pictures that look cut, some that are of
// another size where the others are as stated. Check: intrinsics-size.
void check_picture_sizes(
    const SceneIndex& index, std::span<const ImageSize> stored, std::vector<Finding>& findings
);

// For people: how many pictures are of another size than stated and by what ratio, which EXIF
// orientation some have, and what is made of alpha.
std::vector<std::string> picture_notes(const SceneIndex& index, std::span<const ImageSize> stored);

// Pictures that are composed are other pictures than what their files say: the scene's hash follows
// what is made of their alpha.
void mark_alpha_use(SceneIndex& index);

}  // namespace glint
