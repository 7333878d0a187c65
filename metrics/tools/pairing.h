// SPDX-License-Identifier: MIT
// Which prediction is compared with which reference: two files, or two folders matched by name.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

// One image of a set: its name is the file's stem, or, where a folder holds a folder per view
// (renders/<view>/rgb.exr, images/<view>/000000.png), the view's.
struct NamedFile {
  std::string name;
  fs::path path;
};

struct FolderLayout {
  std::vector<std::string> subfolders;  // looked into first when they exist: "renders", "gt/depth"
  std::vector<std::string> files;       // wanted in a view's folder, best first: "rgb.exr"
};

// The images of a folder in natural order. `pattern` (glob on the file's name), when not empty,
// replaces layout.files and selects among files side by side. Errors (kBadReference): not a folder,
// no image, two images of one name, several images in a view's folder and none of the wanted ones.
std::vector<NamedFile> list_images(
    const fs::path& folder, const FolderLayout& layout, const std::string& pattern = {}
);

struct FilePair {
  std::string name;
  fs::path prediction, reference, mask, glass;  // mask, glass: empty when there is none
};

struct PairingOptions {
  // Files, folders, or globs in a file's name ("renders/*_rgb.png"); mask and glass may be empty.
  fs::path prediction, reference, mask, glass;
  std::string pattern;  // of predictions
  bool allow_missing = false;
  FolderLayout prediction_layout, reference_layout, mask_layout;
};

struct Pairing {
  std::vector<FilePair> pairs;       // in natural order of the names
  std::vector<std::string> missing;  // names that only one side has
};

// A mask file serves every pair; a mask folder must have every name. Errors: kUsage (file against
// folder), kBadPrediction (missing path, names that only one side has unless allow_missing, no
// common name), kBadReference (missing path, names without mask).
Pairing pair_files(const PairingOptions& options);

}  // namespace glint
