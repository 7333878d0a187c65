// SPDX-License-Identifier: MIT
// A profile: which scenes, methods and seeds `all` runs, and how long. TOML files in
// reports/profiles, compiled in; or a file of the user's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/glassroom/prior_levels.h"
#include "datasets/prior_options.h"
#include "glint/core/config.h"
#include "metrics/fusion/tsdf.h"
#include "metrics/mesh/mesh_protocol.h"

namespace glint {

// A scene of a profile: made by GlassRoom, or a folder that a loader knows.
struct SceneSource {
  std::string dataset;     // "glassroom", or the name shown for a folder's data
  std::string scene;       // "room_1"; for folders the name shown, unique in the profile
  std::string folder;      // folders: where it lies, relative to --data unless absolute
  std::string loader;      // folders: id of the loader to take; empty: the surest
  double max_pixels = 0;   // folders: images shrunk below this area; 0: as stored
  double image_ratio = 1;  // folders: both sides of images times this, rounded down
  std::string manifest;    // id of the published dataset it is a scene of; empty: none
  int width = 160, height = 90, views = 64, spp = 128;  // glassroom
  std::uint64_t seed = 0;                               // glassroom: varies the layout
  std::string assets;                                   // empty; earlier: glTF furniture
  std::string room;                                     // glassroom; empty: `scene`
  std::string priors = kDefaultPriorLevel;              // glassroom: one of kPriorLevels
  PriorOptions foreign_priors = {};                     // folders: priors of other programs

  bool made() const { return folder.empty(); }

  template <class V>
  void visit(V&& v) {
    v("dataset", dataset, "dataset the scene belongs to");
    v("scene", scene, "name of the scene");
    v("folder", folder, "folder with the data; empty: made by GlassRoom");
    v("loader", loader, "loader that reads the folder; empty: the one that is surest of it");
    v("max_pixels", max_pixels, "shrink images below this area; 0: as stored");
    v("image_ratio", image_ratio, "both sides of images times this, rounded down");
    v("width", width, "pixels");
    v("height", height, "pixels");
    v("views", views, "views along the camera path");
    v("spp", spp, "samples a pixel");
    v("seed", seed, "varies the layout of a room");
    v("assets", assets, "empty; earlier versions: folder with glTF furniture");
    v("room", room, "room that is made, where the scene is called otherwise");
    v("priors",
      priors,
      "how good simulated priors are: perfect, good, default, poor, bad, or one flaw");
    v("prior_folder", foreign_priors.folder, "folder with priors as other programs write them");
    v("prior_axes", foreign_priors.axes, "of normals: auto, opencv, opengl, stablenormal, world");
    v("prior_depth", foreign_priors.depth, "of depth: auto, linear, disparity, inverted");
    v("prior_overlap", foreign_priors.overlap, "frames that two chunks share; else told");
    v("albedo_from_basecolor",
      foreign_priors.albedo_from_basecolor,
      "base colour x (1 - metallic) where there is no albedo");
  }
};

struct Profile {
  std::string name, description;
  int iterations = 1000;               // of every method
  std::vector<std::string> methods;    // ids, globs of them (named_methods)
  std::vector<std::string> leave_out;  // globs of cells, as of --skip, that are none of its
  std::vector<std::uint64_t> seeds{0};
  int timing_frames = 50, timing_warmup = 5;
  int test_psnr_every = 0;             // steps between looks at test views, for figures; 0: none
  int gpus = 0;                        // that a cell asks a cluster for
  Json defaults = Json::object();      // SceneSource fields shared by all scenes
  Json scenes = Json::array();         // names, or objects with SceneSource fields
  std::vector<std::string> manifests;  // ids of datasets whose scenes come after `scenes`
  Json overrides = Json::object();     // method id -> config fields
  Json mesh = Json::object();          // TsdfOptions fields of the mesh stage
  Json mesh_metrics = Json::object();  // MeshProtocol fields; its tolerance is otherwise 2 voxels

  template <class V>
  void visit(V&& v) {
    v("description", description, "one line");
    v("iterations", iterations, "training steps");
    v("methods", methods, "method ids, globs of them");
    v("leave_out", leave_out, "globs of cells that it does not have, as of --skip");
    v("seeds", seeds, "seeds of training");
    v("timing_frames", timing_frames, "frames timed for FPS");
    v("timing_warmup", timing_warmup, "frames before the clock starts");
    v("test_psnr_every", test_psnr_every, "steps between looks at test views, for figures");
    v("gpus", gpus, "that a cell asks a cluster for");
    v("defaults", defaults, "scene fields shared by all scenes");
    v("scenes", scenes, "names, or tables of scene fields");
    v("manifests", manifests, "published datasets, below --data: ref-dl3dv, 3d-front-t");
    v("overrides", overrides, "config fields by method");
    v("mesh", mesh, "extraction: voxel, truncation_voxels, ...");
    v("mesh_metrics", mesh_metrics, "comparison: num_samples, thresholds_m, ...");
  }

  // Errors (kUsage): unknown fields of [mesh] and [mesh_metrics], a voxel without an edge.
  TsdfOptions tsdf_options() const;
  MeshProtocol mesh_protocol() const;

  // Errors (kUsage): a scene without a name, an unknown field or level of priors, a name twice.
  std::vector<SceneSource> sources() const;
};

// `name`: an embedded profile, or the path of a TOML file (its stem becomes the name).
// Errors (kUsage): neither, the message lists the embedded ones; what the members say; a method or
// a seed twice, [mesh_metrics] that cannot be (check_mesh_protocol()).
Profile load_profile(const std::string& name);

// The fields of `assignments` ("name=value", or "method.name=value" for one method) laid over the
// profile's overrides of `method`, as create() of a MethodSpec takes them. Errors (kUsage).
Json method_overrides(
    const Profile& profile, const std::string& method, const std::vector<std::string>& assignments
);

}  // namespace glint
