// SPDX-License-Identifier: MIT
// A folder of photos becomes a dataset: the program COLMAP, where it is installed, finds cameras
// and points.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

struct PhotoOptions {
  std::string lens = "OPENCV";  // of kColmapLenses: those that are undone when the folder is read
  std::string matcher =
      "auto";           // exhaustive: all pairs; sequential: a video's; auto: by their number
  int max_side = 1600;  // pixels of the photos that features are looked for in
  int threads = 0;      // 0: all cores
  // Folder with masks of the pixels that count (white), PNG, by the photos' paths: day/p1.png or
  // COLMAP's day/p1.jpg.png of day/p1.jpg. Photos without: all count. Empty: there are none.
  std::string masks;
};

struct PhotoModel {
  std::size_t photos = 0, points = 0;
  std::vector<std::string> unposed;  // photos that have no place in the model
  std::size_t other_models = 0;      // smaller ones, of photos that do not hang together
  std::string matcher;               // the one that was taken
  std::size_t masks = 0;             // of photos that have a camera
};

// Fills `out` with images/ (those that have poses), sparse/0/ and counted/ as the colmap loader
// reads it. Features are looked for only where pixels count.
// Work lies in OUT.colmap meanwhile, with COLMAP's words in colmap.log, and stays there when
// something goes wrong: the same call goes on from it. Errors: kUsage (`out` holds files; another
// process is at work there); kBadReference (no photos, fewer than three, photos that COLMAP cannot
// place, no mask of any photo); kEnvironment (no COLMAP; it crashed).
PhotoModel import_photos(const fs::path& photos, const fs::path& out, const PhotoOptions& options);

}  // namespace glint
