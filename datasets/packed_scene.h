// SPDX-License-Identifier: MIT
// A whole Scene in one safetensors file (docs/reference/formats.md): what a loader made of a
// folder, so that reading it needs no image library and gives the same floats.
#pragma once

#include "glint/core/files.h"
#include "glint/scene/scene.h"

namespace glint {

// Does the file call itself one, of any version? False, too, when it cannot be read.
bool is_packed_scene(const fs::path& file);

// Without loss, each map in the samples that it was made of where those are known (map_codes.h).
// Errors (kBadReference): what read_packed_scene() would not read; kEnvironment: as write_file.
void write_packed_scene(const fs::path& file, const Scene& scene);

// Leaves out what no training reads and no score: the truth of train views but their glass masks,
// on which methods train where there are no others (glint/train/glass_masks.h).
void leave_out_train_truth(Scene& scene);

// Beside that, of test views all that is not scored: their priors but glass masks, true maps of
// which runs have no files, what lies behind glass where there is none. True depth is brought to
// steps of an eighth of a millimetre (rooms of up to 8 m), radiance to 16-bit floats, which moves
// no score by 1e-5. Trainings end with the same bytes.
void make_compact(Scene& scene);

// Errors (kUsage): no view has a prior of that id.
void leave_out_prior(const std::string& id, Scene& scene);

// The scene, bit for bit. Errors (kBadReference): SafetensorsFile's; tensors that are missing,
// unknown, of another type or shape than the cameras say; cameras that are none; values that are
// not finite; no train view.
Scene read_packed_scene(const fs::path& file);

}  // namespace glint
