// SPDX-License-Identifier: MIT
// Scenes as folders that other programs train on. One file a format, registered with
// GLINT_REGISTER(ExporterSpec, ...); a loader reads what it writes (tests/datasets/export).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/registry.h"
#include "glint/scene/scene.h"

namespace glint {

struct ExportView {
  const View* view;
  bool is_test;
  std::string name;  // of its files, without extension: letters, digits, '_' and '-'
};

struct ExportInput {
  const Scene& scene;
  std::vector<ExportView> views;  // names in the order of bytes
};

// What people are told.
struct ExportReport {
  struct Part {
    std::string files, what;  // "images/", "40 PNG, 8 bit"
  };
  std::vector<Part> parts;
  std::vector<std::string> notes;  // what is lost, what trainers do with it

  void add(std::string_view files, std::string_view what);
  void note(std::string_view text);
};

struct ExporterSpec {
  std::string id;
  std::string writes;  // one line: which programs read it
  // Fills `folder`, which is there and empty; may give views other names and another order. Errors
  // (kUsage): cameras that the format cannot hold.
  std::function<void(ExportInput&, const fs::path& folder, ExportReport&)> write;
  bool has_scene_maps = false;  // a place for all maps; else those of side_maps.h are written
  bool names_counted = false;   // its files name masks of the pixels that count
  std::string source = {};      // the file that registers it
};

enum class ExportSplit { kAll, kTrain, kTest };

struct ExportOptions {
  std::string format;  // id of an ExporterSpec
  ExportSplit split = ExportSplit::kAll;
  bool force = false;  // an earlier export in the folder is replaced; what others put there stays
};

// Fills a folder beside `folder` and lets it take its place (replace_folder.h). Errors (kUsage): no
// such format (all are listed); no views in the split; a folder that is not empty, without `force`
// or when it is no export; (kEnvironment): cannot be written.
ExportReport export_scene(const Scene& scene, const fs::path& folder, const ExportOptions& options);

// export_scene()'s errors (kUsage) that can be told before a scene is loaded.
void check_export(const fs::path& folder, const ExportOptions& options);

// The views of the split in natural order, named for files: their own names where those keep the
// order byte by byte, else with a number in front.
std::vector<ExportView> export_views(const Scene& scene, ExportSplit split);

}  // namespace glint
