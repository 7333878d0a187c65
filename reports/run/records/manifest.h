// SPDX-License-Identifier: MIT
// Published datasets: which scenes they have, how these are split, where they lie below --data, and
// what is known of them. TOML files in reports/manifests, compiled in. No data come along.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/findings.h"
#include "glint/core/config.h"
#include "glint/core/files.h"
#include "glint/core/vec.h"

namespace glint {

struct ManifestScene {
  std::string name;    // "scene_1", "194defaa"
  std::string folder;  // of the release; a longer name may be cut to `name`
  int train = 0, test = 0;
  double spatial_scale = 0;  // 1.1 x largest distance of train cameras to their mean
  std::vector<double> bounds_min, bounds_max;  // of the points, metres; empty: not published

  template <class V>
  void visit(V&& v) {
    v("name", name, "of the scene");
    v("folder", folder, "of the release");
    v("train", train, "training views");
    v("test", test, "test views");
    v("spatial_scale", spatial_scale, "1.1 x largest distance of train cameras to their mean");
    v("bounds_min", bounds_min, "of the points");
    v("bounds_max", bounds_max, "of the points");
  }
};

struct Manifest {
  std::string id;             // "ref-dl3dv": dataset of records, folder below --data
  std::string title;          // as tables print it
  std::string paper_dataset;  // as the paper's tables call it
  std::string about, source;  // one line; where the data are had
  double image_ratio = 1;     // of the stored pictures' sides
  int test_every = 8;
  Json scenes_json = Json::array();
  std::vector<ManifestScene> scenes;

  template <class V>
  void visit(V&& v) {
    v("title", title, "as tables print it");
    v("paper_dataset", paper_dataset, "as the paper's tables call it");
    v("about", about, "one line");
    v("source", source, "where the data are had");
    v("image_ratio", image_ratio, "of the stored pictures' sides");
    v("test_every", test_every, "view 0, n, 2n, ... is a test view");
    v("scenes", scenes_json, "scenes");
  }
};

// In the order of their ids.
const std::vector<Manifest>& manifests();
// Null: none is called so.
const Manifest* find_manifest(const std::string& id);

// Where a scene lies: DATA/<id>/<folder>, or <name> in place of the folder where only that is
// there.
fs::path manifest_scene_folder(
    const Manifest& manifest, const ManifestScene& scene, const fs::path& data_folder
);

// One scene of a manifest as it is found.
struct ManifestSceneState {
  std::string name;
  fs::path folder;
  bool there = false;
  std::size_t train = 0, test = 0;
  std::size_t with_depth = 0;            // test views with true depth
  std::string stored_size, loaded_size;  // "1920x1080"
  std::string hash;                      // of cameras, points and pictures
  std::string first_hash;                // what it was when it was first seen; empty: just now
  std::vector<Finding> findings;         // against the manifest, and a changed hash
};

// Looks at all scenes; reads cameras, points and one picture of each, and with `with_hashes` all
// bytes of them once (hashes are cached below DATA/.hashes). Hashes are kept at first sight in
// DATA/<id>.hashes.json. Errors (kEnvironment): that file cannot be written.
std::vector<ManifestSceneState> examine_manifest(
    const Manifest& manifest, const fs::path& data_folder, bool with_hashes
);

// "3d-front-t: 2 of 5 scenes are missing (scene_4, scene_5); ...", with where to get them and where
// to put them. Empty: none is.
std::string missing_scenes_text(const Manifest& manifest, const fs::path& data_folder);

}  // namespace glint
