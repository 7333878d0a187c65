// SPDX-License-Identifier: MIT
// Pixels that a dataset's masks leave out (View::counted): people who walked by, lens edges, faces
// made unrecognisable.
#pragma once

#include <string>

#include "glint/core/files.h"
#include "glint/scene/scene.h"

namespace glint {

// [H][W][1] 0 or 1: white counts. A mask of the same shape is brought to `size`. Errors
// (kBadReference): unreadable, of another shape, no pixel that counts.
Image read_counted(const fs::path& path, ImageSize size);

// A picture at another size, from the pixels that count alone: none of the others bleeds into it.
Image resize_counted(const Image& rgb, const Image& counted, ImageSize size);

// Where a pixel does not count, the picture is grey and no other map but masks has a value. A mask
// in which all count is dropped. Errors (kBadReference): none counts.
void blank_uncounted(View& view);

// "12 of 40 train views and ... have pixels that do not count, 3.1 % and ..."; empty: all count.
std::string counted_note(const Scene& scene);

}  // namespace glint
