// SPDX-License-Identifier: MIT
// Loaders: one file each, registered with GLINT_REGISTER(LoaderSpec, ...); load_scene() asks each
// how sure it is that the folder (or the file of a packed scene) is its own, and takes the surest.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "datasets/findings.h"
#include "datasets/prior_options.h"
#include "glint/core/files.h"
#include "glint/core/registry.h"
#include "glint/scene/scene.h"

namespace glint {

struct LoadOptions {
  ImageSize size;           // images resized to this (area average); {0, 0}: as stored
  double image_ratio = 1;   // or: both sides times this, rounded down (area average)
  double max_pixels = 0;    // or: shrink so that width x height stays below; 0: as stored
  int test_every = 8;       // view index % test_every == 0 is a test view (unless the data says)
  bool test_only = false;   // leave the training views out where that saves reading them
  bool with_truth = true;   // read gt/
  bool with_priors = true;  // read diffrens/
  std::string loader;       // id of the loader to take; empty: the surest
  // What is made of alpha: black, white, mask or stored (docs/reference/formats.md); empty: what
  // the folder says of itself, else its format's custom.
  std::string background;
  PriorOptions priors = {};  // how those of other programs are stored
};

enum class Sureness {
  kNone,      // not its data
  kName,      // a file has the right name; load() will say what is missing
  kContents,  // all that it needs is there, and what was looked into holds the right things
};

struct LoaderMatch {
  Sureness sureness = Sureness::kNone;
  std::string reason = {};  // what was found: "intri.yml, extri.yml and images"
};

struct LoaderSpec {
  std::string name;
  std::function<LoaderMatch(const fs::path&)> match;
  std::function<Scene(const fs::path&, const LoadOptions&)> load;
  std::string looks_for = {};  // e.g. "transforms.json"; listed when no loader knows a folder
  // What check_dataset() calls; empty: it only tries load().
  std::function<std::vector<Finding>(const fs::path&, const LoadOptions&)> check = {};
  // How it chooses the test views of a folder, in words; empty: they come with the data.
  std::function<std::string(const fs::path&)> split_rule = {};
  // What a folder says before any picture is read: names and cameras of the views (size 0 where it
  // is not stated), points, bounds and extent. Empty: load() is the only way.
  std::function<Scene(const fs::path&, const LoadOptions&)> outline = {};
  std::string source = {};  // the file that registers it, as the compiler calls it
};

inline const std::string& registry_id(const LoaderSpec& loader) { return loader.name; }

// The loader called `id`; if empty, the one that is surest of the folder. Errors (kBadReference):
// none knows it, and what each looks for is listed; two are as sure, both are named with what they
// found and the ways to say which; (kUsage): no loader is called `id`.
const LoaderSpec& find_loader(const fs::path& folder, const std::string& id = "");
// Errors (kBadReference): find_loader()'s, bad data.
Scene load_scene(const fs::path& folder, const LoadOptions& options);

// Views, image sizes, split, priors, ground truth, points and extent, one line each.
std::string describe_scene(const Scene& scene);

// Everything wrong with a dataset folder, not only the first thing; of a packed scene the first.
// Empty: clean. Of the options the loader and those of priors count. Errors: find_loader()'s;
// kEnvironment: load_scene()'s.
std::vector<Finding> check_dataset(const fs::path& folder, const LoadOptions& options = {});

}  // namespace glint
