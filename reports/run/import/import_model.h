// SPDX-License-Identifier: MIT
// Gaussians that another program trained become a run folder like our own, so that rendering,
// meshing and scoring treat them alike.
#pragma once

#include <string>
#include <vector>

#include "reports/run/records/run_folder.h"

namespace glint {

// The sets of a model and the method of ours that renders them.
struct ModelFiles {
  struct Set {
    std::string name;  // as our runs call it: "interface.ply", "transmission.ply", "reflection.ply"
    fs::path path;
    std::vector<std::string> channels;  // that it needs beside colour
  };
  std::string method;  // "2dgs": one set; "envgs": interface and reflection; "glint": all three
  Json config = Json::object();  // of the method: how the official code traces such sets
  std::vector<Set> sets;
};

// `model`: a PLY with Gaussians; a folder with one for each set (interface.ply, transmission.ply,
// reflection.ply, or pcd.ply, trans_env.ply, env.ply); or the output of 3DGS, 2DGS or PGSR, whose
// last iteration counts. Errors (kBadPrediction): nothing there; sets that belong to no method.
ModelFiles find_model(const fs::path& model);

// Fills spec.folder (surfel PLYs, config.json, env.json, the training's key) from a model of
// find_model(). spec.train_document is that of spec.method without iterations. Returns notes for
// people, which the run's records keep: what was read, what was dropped. Errors (kBadPrediction):
// read_gaussian_ply()'s.
std::vector<std::string> import_model(
    const fs::path& model, const ModelFiles& files, const RunSpec& spec
);

// The name of a row in tables for what another program made. Errors (kUsage): none, one of our
// methods', no name for a folder.
void check_row_name(const std::string& name);

}  // namespace glint
