// SPDX-License-Identifier: MIT
#include "metrics/tools/pairing.h"

#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

std::vector<std::string> extensions() {
  std::vector<std::string> all = kPictureExtensions;
  all.insert(all.end(), {".exr", ".npy", ".tif", ".tiff"});
  return all;
}
const std::vector<std::string> kExtensions = extensions();

fs::path enter_layout(const fs::path& folder, const FolderLayout& layout) {
  for (const std::string& name : layout.subfolders)
    if (is_folder(folder / name)) return folder / name;
  return folder;
}

std::vector<fs::path> matching(std::vector<fs::path> files, const std::string& pattern) {
  if (pattern.empty()) return files;
  std::erase_if(files, [&](const fs::path& file) {
    return !glob_match(pattern, file.filename().string());
  });
  return files;
}

// The image of one view's folder; empty when it has none.
fs::path image_in(const fs::path& folder, const FolderLayout& layout, const std::string& pattern) {
  const std::vector<fs::path> files = matching(list_files(folder, kExtensions), pattern);
  if (pattern.empty())
    for (const std::string& wanted : layout.files)
      for (const fs::path& file : files)
        if (file.filename() == wanted) return file;
  GLINT_CHECK(
      files.size() <= 1,
      kBadReference,
      "{}: {} images ({}, {}, ...); choose one with --pattern",
      folder.string(),
      files.size(),
      files[0].filename().string(),
      files[1].filename().string()
  );
  return files.empty() ? fs::path() : files[0];
}

// A path that is there is never a glob, whatever its name.
bool is_glob(const fs::path& path) {
  return path.filename().string().find_first_of("*?[") != std::string::npos && !is_there(path);
}

void check_exists(const fs::path& path, ExitCode exit_code, const char* what) {
  if (!is_there(path))
    throw Error(exit_code, fmt::format("{}: no such file or folder ({})", path.string(), what));
}

FilesByName list_by_name(
    const fs::path& path, const FolderLayout& layout, const std::string& pattern
) {
  FilesByName files;
  for (const NamedFile& file : list_inputs(path, layout, pattern)) files[file.name] = file.path;
  return files;
}

std::string joined(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i)
    text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > kShown ? text + ", ..." : text;
}

// The files of a glob by the part of their names that '*' and '?' stand for, so that
// "frame1_rgb.png" and "frame1_gt.png" are a pair: common beginnings and ends are cut off.
FilesByName list_glob(const fs::path& glob) {
  const std::string pattern = glob.filename().string();
  const std::size_t head = pattern.find_first_of("*?[");
  const std::size_t tail = pattern.size() - 1 - pattern.find_last_of("*?]");
  const fs::path folder = glob.has_parent_path() ? glob.parent_path() : fs::path(".");
  FilesByName files;
  for (const fs::path& file : list_files(folder, kExtensions)) {
    const std::string name = file.filename().string();
    if (glob_match(pattern, name)) files[name.substr(head, name.size() - head - tail)] = file;
  }
  GLINT_CHECK(!files.empty(), kBadReference, "{}: matches no image", glob.string());
  return files;
}

std::vector<NamedFile> in_order(const FilesByName& files) {
  std::vector<NamedFile> images;
  for (const auto& [name, path] : files) images.push_back({name, path});
  return images;
}

void check_missing(const Pairing& pairing, const PairingOptions& options) {
  const std::string where = options.prediction.string() + " against " + options.reference.string();
  GLINT_CHECK(
      !pairing.pairs.empty(),
      kBadPrediction,
      "{}: no name in common; found only on one side: {}",
      where,
      joined(pairing.missing)
  );
  GLINT_CHECK(
      pairing.missing.empty() || options.allow_missing,
      kBadPrediction,
      "{}: {} names only on one side: {}; add them, or score the others with --allow-missing",
      where,
      pairing.missing.size(),
      joined(pairing.missing)
  );
}

Pairing match_by_name(const FilesByName& predictions, const FilesByName& references) {
  Pairing pairing;
  for (const auto& [name, path] : references)
    if (const auto found = predictions.find(name); found != predictions.end())
      pairing.pairs.push_back({name, found->second, path, {}, {}});
    else
      pairing.missing.push_back(name + " (no prediction)");
  for (const auto& [name, path] : predictions)
    if (!references.contains(name)) pairing.missing.push_back(name + " (no reference)");
  return pairing;
}

// The glass masks of a packed scene, which has no files of them.
void add_packed_glass(const PairingOptions& options, Pairing& pairing) {
  pairing.datasets.push_back(std::make_shared<DatasetViews>(options.glass, true, options.prediction)
  );
  const auto views = pairing.datasets.back()->with_map("glass");
  for (FilePair& pair : pairing.pairs) {
    const auto found = views.find(pair.name);
    GLINT_CHECK(
        found != views.end(),
        kBadReference,
        "{}: no glass mask of view '{}'",
        options.glass.string(),
        pair.name
    );
    pair.glass = options.glass;
    pair.glass_view = found->second;
  }
}

void add_masks(const PairingOptions& options, Pairing& pairing) {
  const MaskFiles masks(options.mask, options.mask_layout);
  for (FilePair& pair : pairing.pairs) pair.mask = masks.of(pair.name);
  if (is_file(options.glass) && is_dataset(options.glass))
    return add_packed_glass(options, pairing);
  const MaskFiles glass(options.glass, options.mask_layout);
  for (FilePair& pair : pairing.pairs) pair.glass = glass.of(pair.name);
}

// Renders against the views of a dataset.
Pairing pair_with_dataset(const PairingOptions& options) {
  const FilesByName predictions = with_exit_code(ExitCode::kBadPrediction, [&] {
    return list_by_name(options.prediction, options.prediction_layout, options.pattern);
  });
  const auto dataset =
      std::make_shared<DatasetViews>(options.reference, options.all_views, options.prediction);
  const auto views = dataset->with_map(options.reference_map);
  GLINT_CHECK(
      !views.empty(),
      kBadReference,
      "{}: no {} of its test views",
      options.reference.string(),
      options.reference_map
  );
  FilesByName references;
  for (const auto& [name, view] : views)
    references[name] = fmt::format(
        "{}: {} of view {}", options.reference.string(), options.reference_map, view->name
    );
  Pairing pairing = match_by_name(predictions, references);
  for (FilePair& pair : pairing.pairs) pair.view = views.at(pair.name);
  pairing.datasets.push_back(dataset);
  check_missing(pairing, options);
  return pairing;
}

// Folders or globs, their names matched.
Pairing pair_by_name(const PairingOptions& options) {
  const FilesByName predictions = with_exit_code(ExitCode::kBadPrediction, [&] {
    return list_by_name(options.prediction, options.prediction_layout, options.pattern);
  });
  Pairing pairing =
      match_by_name(predictions, list_by_name(options.reference, options.reference_layout, {}));
  check_missing(pairing, options);
  return pairing;
}

Pairing pair_paths(const PairingOptions& options) {
  if (is_glob(options.prediction) || is_glob(options.reference)) return pair_by_name(options);
  check_exists(options.prediction, ExitCode::kBadPrediction, "prediction");
  check_exists(options.reference, ExitCode::kBadReference, "reference");
  const bool folders = is_folder(options.reference);
  const bool packed = !folders && is_dataset(options.reference);
  if (is_folder(options.prediction) && !options.reference_map.empty() &&
      (packed || (!options.all_views && is_dataset(options.reference))))
    return pair_with_dataset(options);
  GLINT_CHECK(
      is_folder(options.prediction) == (folders || packed),
      kUsage,
      "{} and {}: one is a folder, the other a file; give two files or two folders",
      options.prediction.string(),
      options.reference.string()
  );
  if (folders) return pair_by_name(options);
  const std::string name = options.prediction.stem().string();
  return {{{name, options.prediction, options.reference, {}, {}}}, {}};
}

}  // namespace

std::vector<NamedFile> list_images(
    const fs::path& folder, const FolderLayout& layout, const std::string& pattern
) {
  const fs::path inside = enter_layout(folder, layout);
  FilesByName files;
  for (const fs::path& file : matching(list_files(inside, kExtensions), pattern)) {
    const auto [entry, fresh] = files.emplace(file.stem().string(), file);
    GLINT_CHECK(
        fresh,
        kBadReference,
        "{}: {} and {} have one name; choose with --pattern",
        inside.string(),
        entry->second.filename().string(),
        file.filename().string()
    );
  }
  if (files.empty())
    for (const fs::path& view : list_folders(inside))
      if (const fs::path file = image_in(view, layout, pattern); !file.empty())
        files.emplace(view.filename().string(), file);
  GLINT_CHECK(
      !files.empty(),
      kBadReference,
      "{}: no image{}{}; expected .png, .jpg, .exr, .npy or .tiff files, or a folder with one per "
      "view",
      inside.string(),
      pattern.empty() ? "" : " matching ",
      pattern
  );
  return in_order(files);
}

std::vector<NamedFile> list_inputs(
    const fs::path& path, const FolderLayout& layout, const std::string& pattern
) {
  return is_glob(path) ? in_order(list_glob(path)) : list_images(path, layout, pattern);
}

MaskFiles::MaskFiles(const fs::path& mask, const FolderLayout& layout) : mask_(mask) {
  if (mask.empty()) return;
  check_exists(mask, ExitCode::kBadReference, "mask");
  if (is_folder(mask)) by_name_ = list_by_name(mask, layout, {});
}

fs::path MaskFiles::of(const std::string& name) const {
  if (by_name_.empty()) return mask_;
  const auto found = by_name_.find(name);
  GLINT_CHECK(
      found != by_name_.end(), kBadReference, "{}: no mask named '{}'", mask_.string(), name
  );
  return found->second;
}

Pairing pair_files(const PairingOptions& options) {
  Pairing pairing = pair_paths(options);
  add_masks(options, pairing);
  return pairing;
}

}  // namespace glint
