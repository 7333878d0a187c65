// SPDX-License-Identifier: MIT
// Priors as other programs write them, found for the views of a scene. In the folder that options
// or scene.json name, or beside the pictures:
//   chunks    CCCC.FFFF.<pass>.png or .jpg in the folder, in a folder of it, or in
//             gbuffer_frames/<clip>/: chunk and frame in it, as both DiffusionRenderers write them.
//             Frames are the pictures in the order of their names, byte by byte.
//   by name   <pass>/<view>.* or <pass>/<view>/<frame>.*, 8 and 16 bit PNG, JPEG, EXR, NPY, TIFF.
//             normals/ is StableNormal's, diffrens/ the official GLINT release's.
#pragma once

#include <optional>

#include "datasets/scene_index.h"

namespace glint {

// How frames of a clip lie in chunks.
struct ChunkGrid {
  std::size_t chunks = 0, frames = 0;  // frames in each chunk
  std::size_t overlap = 0;             // frames that two neighbours share

  std::size_t step() const { return frames - overlap; }
  // Frames from the first to the last; the last chunk may end in repeats of the last picture.
  std::size_t covered() const { return chunks == 0 ? 0 : step() * (chunks - 1) + frames; }
};

struct ChunkFrame {
  std::size_t chunk, frame;
};

// Where picture i lies; of several copies that nearest to the middle of its chunk, where the
// network saw most around it, and of two as near that of the later chunk. i < covered().
ChunkFrame frame_of_picture(const ChunkGrid& grid, std::size_t i);

// All that other programs left for the views of a scene.
struct FoundPriors {
  std::string program;             // "DiffusionRenderer, SVD"
  std::vector<MapFiles> files;     // one a view; a kind that no view has is missing
  std::vector<fs::path> metallic;  // one a view
  PriorReading documented;         // how the program stores them
  std::vector<std::string> notes;

  explicit FoundPriors(std::size_t num_views) : files(num_views), metallic(num_views) {}
};

// Of files CCCC.FFFF.<pass>.png of one clip. Nothing: no such files. `overlap`: as in PriorOptions.
// Errors (kBadReference): as attach_priors.
std::optional<FoundPriors> find_chunked_priors(
    const fs::path& folder, const SceneIndex& index, int overlap
);

// Adds priors of other programs to the views, with a note for each thing that people should know.
// `options` go before index.stated_priors. Priors of a named folder take the place of others of
// their kind; those beside the pictures fill in only kinds that no view has. Errors (kUsage,
// kBadReference): unknown words, no such folder, nothing in it that is known, several clips, chunks
// that do not fit the number of pictures.
void attach_priors(const fs::path& folder, const PriorOptions& options, SceneIndex& index);

// The options that count: those given, then those of scene.json.
PriorOptions merged_priors(const PriorOptions& given, const PriorOptions& stated);

}  // namespace glint
