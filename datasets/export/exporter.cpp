// SPDX-License-Identifier: MIT
#include "datasets/export/exporter.h"

#include <algorithm>

#include "datasets/export/export_files.h"
#include "datasets/holdout.h"
#include "datasets/side_maps.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/core/replace_folder.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr const char* kExportedBy = "glint-bench dataset export";
constexpr const char* kDescription = "scene.json";
constexpr const char* kFiles = "exported_files";  // there: names of all that an export wrote

const ExporterSpec& exporter_called(const std::string& id) {
  const auto& exporters = Registry<ExporterSpec>::all();
  if (const auto found = exporters.find(id); found != exporters.end()) return found->second;
  std::string list;
  for (const auto& [name, exporter] : exporters)
    list += fmt::format("\n  {}: {}", name, exporter.writes);
  throw Error(ExitCode::kUsage, fmt::format("--format {}: no such format. There are:{}", id, list));
}

Json description_of(const fs::path& folder) {
  const fs::path file = folder / kDescription;
  return is_file(file) ? parse_json(read_file(file)) : Json();
}

bool is_export(const fs::path& folder) {
  const Json json = description_of(folder);
  return json.is_object() && json.value("exported_by", Json()) == kExportedBy;
}

// By its list; of exports that have none, all that lies where the new one has something.
std::set<std::string> own_names(const fs::path& old, const fs::path& fresh) {
  std::set<std::string> names = {kDescription};
  const Json json = description_of(old);
  if (const Json listed = json.is_object() ? json.value(kFiles, Json()) : Json();
      listed.is_array()) {
    for (const Json& name : listed)
      if (name.is_string()) names.insert(name.get<std::string>());
    return names;
  }
  for (const std::string& name : leaves_below(old))
    if (is_there(fresh / *fs::path(name).begin())) names.insert(name);
  return names;
}

// Nothing but an earlier export is ever removed.
void check_folder(const fs::path& folder, bool force) {
  recover_folder(folder, own_names);
  if (!is_there(folder)) return;
  GLINT_CHECK(
      is_folder(folder), kUsage, "{}: is a file; expected a folder or a new name", folder.string()
  );
  if (fs::is_empty(folder)) return;
  GLINT_CHECK(
      is_export(folder),
      kUsage,
      "{}: is not empty and holds no earlier export; give another --out, or empty it yourself",
      folder.string()
  );
  GLINT_CHECK(force, kUsage, "{}: holds an earlier export; --force replaces it", folder.string());
}

// Names of the views that lack a prior which another one has.
std::vector<std::string> without_priors(const std::vector<ExportView>& views) {
  std::vector<std::string> names;
  const auto someone_has = [&](const MapRow& row) {
    return std::any_of(views.begin(), views.end(), [&](const ExportView& view) {
      return view.view->priors.has(row);
    });
  };
  for (const ExportView& view : views)
    if (std::any_of(maps().begin(), maps().end(), [&](const MapRow& row) {
          return !view.view->priors.has(row) && someone_has(row);
        }))
      names.push_back(view.name);
  return names;
}

void write_scene_json(
    const ExportInput& input, const ExporterSpec& exporter, const fs::path& folder
) {
  const Scene& scene = input.scene;
  Json json = {
      {"name", scene.name},
      {"dataset", scene.dataset},
      {"simulated_priors", scene.simulated_priors},
      {"without_priors", without_priors(input.views)},
      {"exported_by", kExportedBy},
      {"format", exporter.id},
      {"hash_of_source", scene.spec_hash},
      {"side_maps", !exporter.has_scene_maps}};
  if (exporter.has_scene_maps) {
    json["test_views"] = Json::array();
    for (const ExportView& view : input.views)
      if (view.is_test) json["test_views"].push_back(view.name);
  }
  if (is_held_out(scene)) json["held_out"] = true;
  json[kFiles] = leaves_below(folder);
  write_file(folder / kDescription, json.dump(1) + "\n");
}

void add_foreign_note(const std::vector<std::string>& foreign, ExportReport& report) {
  if (foreign.empty()) return;
  report.note(fmt::format(
      "{} that {} no export stayed: {}{}",
      foreign.size() == 1 ? "a file" : fmt::format("{} files", foreign.size()),
      foreign.size() == 1 ? "is of" : "are of",
      foreign.front(),
      foreign.size() == 1 ? "" : ", ..."
  ));
}

void add_scene_notes(const ExportInput& input, ExportReport& report) {
  const Scene& scene = input.scene;
  if (is_held_out(scene)) report.note(kHeldOutNote);
  if (scene.simulated_priors)
    report.note("priors are simulated: say so beside every number that uses them");
  const bool renamed =
      std::any_of(input.views.begin(), input.views.end(), [](const ExportView& view) {
        return view.name != view.view->name;
      });
  if (renamed)
    report.note("files are not called as the views: renders go back by the order of test views");
  if (scene.points.positions.empty())
    report.note(
        "the scene has no points: trainers start from random ones (gsplat: --init_type random)"
    );
}

// Masks of the views that have one.
void write_counted(
    const ExportInput& input,
    const ExporterSpec& exporter,
    const fs::path& folder,
    ExportReport& report
) {
  std::size_t count = 0;
  for (const ExportView& view : input.views) {
    if (view.view->counted.empty()) continue;
    write_png(folder / counted_file(view.name), view.view->counted);
    ++count;
  }
  if (count == 0) return;
  report.add("counted/", fmt::format("{} PNG, white: the pixel counts", count));
  if (!exporter.names_counted)
    report.note(
        "pixels that do not count are grey; the format does not name their masks (counted/): other "
        "trainers take the grey for the scene"
    );
}

}  // namespace

void ExportReport::add(std::string_view files, std::string_view what) {
  parts.push_back({std::string(files), std::string(what)});
}

void ExportReport::note(std::string_view text) { notes.emplace_back(text); }

std::vector<ExportView> export_views(const Scene& scene, ExportSplit split) {
  std::vector<ExportView> views;
  for (const bool is_test : {false, true}) {
    if (split == (is_test ? ExportSplit::kTrain : ExportSplit::kTest)) continue;
    for (const View& view : is_test ? scene.test : scene.train)
      views.push_back({&view, is_test, export_name(view.name)});
  }
  std::sort(views.begin(), views.end(), [](const ExportView& a, const ExportView& b) {
    return natural_less(a.view->name, b.view->name);
  });
  const auto not_before = [](const ExportView& a, const ExportView& b) { return a.name >= b.name; };
  if (std::adjacent_find(views.begin(), views.end(), not_before) != views.end())
    number_names(views);
  return views;
}

void check_export(const fs::path& folder, const ExportOptions& options) {
  exporter_called(options.format);
  check_folder(absolute_folder(folder), options.force);
}

ExportReport export_scene(const Scene& scene, const fs::path& to, const ExportOptions& options) {
  const ExporterSpec& exporter = exporter_called(options.format);
  const fs::path folder = absolute_folder(to);
  check_folder(folder, options.force);
  ExportInput input{scene, export_views(scene, options.split)};
  GLINT_CHECK(!input.views.empty(), kUsage, "{}: no views in that split", scene.name);
  ExportReport report;
  const UnfinishedFolder unfinished(folder);
  exporter.write(input, unfinished.path(), report);
  write_counted(input, exporter, unfinished.path(), report);
  if (!exporter.has_scene_maps) write_side_maps(input, unfinished.path(), report);
  write_scene_json(input, exporter, unfinished.path());
  add_scene_notes(input, report);
  add_foreign_note(replace_folder(unfinished.path(), folder, own_names), report);
  return report;
}

}  // namespace glint
