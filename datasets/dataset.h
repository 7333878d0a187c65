// SPDX-License-Identifier: MIT
// Loaders: one file each, registered with GLINT_REGISTER(LoaderSpec, ...); load_scene() asks each
// whether it knows the folder (or the file of a packed scene).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "datasets/findings.h"
#include "glint/core/files.h"
#include "glint/core/registry.h"
#include "glint/scene/scene.h"

namespace glint {

struct LoadOptions {
  ImageSize size;           // images resized to this (area average); {0, 0}: as stored
  double max_pixels = 0;    // or: shrink so that width x height stays below; 0: as stored
  int test_every = 8;       // view index % test_every == 0 is a test view (unless the data says)
  bool with_truth = true;   // read gt/
  bool with_priors = true;  // read diffrens/
};

struct LoaderSpec {
  std::string name;
  std::function<bool(const fs::path&)> can_load;
  std::function<Scene(const fs::path&, const LoadOptions&)> load;
  std::string looks_for = {};  // e.g. "transforms.json"; listed when no loader knows a folder
  // What check_dataset() calls; empty: it only tries load().
  std::function<std::vector<Finding>(const fs::path&)> check = {};
};

inline const std::string& registry_id(const LoaderSpec& loader) { return loader.name; }

// The loader that knows the folder. Errors (kBadReference): none does; what each looks for is
// listed.
const LoaderSpec& find_loader(const fs::path& folder);
// Errors (kBadReference): find_loader()'s, bad data.
Scene load_scene(const fs::path& folder, const LoadOptions& options);

// Views, image sizes, split, priors, ground truth, points and extent, one line each.
std::string describe_scene(const Scene& scene);

// Everything wrong with a dataset folder, not only the first thing; of a packed scene the first.
// Empty: clean. Errors (kBadReference): no loader knows the folder; kEnvironment: load_scene()'s.
std::vector<Finding> check_dataset(const fs::path& folder);

}  // namespace glint
