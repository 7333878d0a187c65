// SPDX-License-Identifier: MIT
// A whole Scene in one safetensors file (docs/PACKED.md): what a loader made of a folder, so that
// reading it needs no image library and gives the same floats.
#pragma once

#include "glint/core/files.h"
#include "glint/scene/scene.h"

namespace glint {

// Does the file call itself one, of any version? False, too, when it cannot be read.
bool is_packed_scene(const fs::path& file);

// Maps are stored in 8 or 16 bits where that loses nothing (k / 255 or k / 65535 is the very
// float), else as floats. Errors (kBadReference): what read_packed_scene() would not read;
// kEnvironment: as write_file.
void write_packed_scene(const fs::path& file, const Scene& scene);

// Leaves out what no training reads and no score: the truth of train views but their glass masks,
// on which methods train where there are no others (glint/train/glass_masks.h).
void leave_out_train_truth(Scene& scene);

// The scene, bit for bit. Errors (kBadReference): SafetensorsFile's; tensors that are missing,
// unknown, of another type or shape than the cameras say; cameras that are none; values that are
// not finite; no train view.
Scene read_packed_scene(const fs::path& file);

}  // namespace glint
