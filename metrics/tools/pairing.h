// SPDX-License-Identifier: MIT
// Which prediction is compared with which reference: two files, or two folders matched by name.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/files.h"
#include "metrics/tools/dataset_views.h"

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

// The same of a glob in a file's name ("maps/*_depth.exr") too: names are what its wildcards stand
// for.
std::vector<NamedFile> list_inputs(
    const fs::path& path, const FolderLayout& layout, const std::string& pattern = {}
);

struct NaturalLess {
  bool operator()(const std::string& a, const std::string& b) const { return natural_less(a, b); }
};
using FilesByName = std::map<std::string, fs::path, NaturalLess>;

// A mask file, which serves every name, or a folder with one per name; or none.
class MaskFiles {
 public:
  // Errors (kBadReference): no such path; those of list_images.
  MaskFiles(const fs::path& mask, const FolderLayout& layout);
  // Empty: no mask. Errors (kBadReference): the folder has none of that name.
  fs::path of(const std::string& name) const;

 private:
  fs::path mask_;
  FilesByName by_name_;
};

struct FilePair {
  std::string name;
  fs::path prediction, reference, mask, glass;  // mask, glass: empty when there is none
  // Of a dataset, in place of the files: its maps are in memory. Null: files.
  const View* view = nullptr;        // the reference
  const View* glass_view = nullptr;  // its mask of glass
};

struct PairingOptions {
  // Files, folders, or globs in a file's name ("renders/*_rgb.png"); mask and glass may be empty.
  fs::path prediction, reference, mask, glass;
  std::string pattern;  // of predictions
  bool allow_missing = false;
  std::string reference_map = {};  // "rgb", "depth": what datasets are asked for
  bool all_views = false;          // of a dataset; else its test views
  FolderLayout prediction_layout, reference_layout, mask_layout;
};

struct Pairing {
  std::vector<FilePair> pairs;                                // in natural order of the names
  std::vector<std::string> missing;                           // names that only one side has
  std::vector<std::shared_ptr<const DatasetViews>> datasets;  // what the views of pairs lie in
};

// A reference or a glass mask that is a dataset (is_dataset) is loaded; with `all_views`, folders
// that hold images side by side are taken as folders. A mask file serves every pair; a mask folder
// must have every name. Errors: kUsage (file against folder), kBadPrediction (missing path, names
// that only one side has unless allow_missing, no common name), kBadReference (missing path, names
// without mask).
Pairing pair_files(const PairingOptions& options);

}  // namespace glint
