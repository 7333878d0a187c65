// SPDX-License-Identifier: MIT
#include "reports/show/page/page_scenes.h"

#include <algorithm>
#include <map>
#include <set>

#include "datasets/released_truth.h"
#include "glint/core/parallel.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/mesh_files.h"
#include "reports/run/records/script_text.h"
#include "reports/show/page/mesh_part.h"
#include "reports/show/page/probe_values.h"
#include "reports/show/pictures/layers.h"
#include "reports/show/pictures/training_curve.h"

namespace glint {

namespace {

std::optional<RunSpec> spec_of(const fs::path& folder) {
  try {
    if (!is_there(folder / "config.json")) return std::nullopt;
    return read_run_spec(folder);
  } catch (const Error& error) {
    log::warn(fmt::format("report: {}", error.what()));
    return std::nullopt;
  }
}

// metrics.json of a run; an empty object where there is none that can be read.
Json read_scores(const fs::path& folder) {
  const fs::path path = folder / "metrics.json";
  const Json json = or_warn([&] { return is_file(path) ? parse_json(read_file(path)) : Json(); });
  if (json.is_null()) return Json::object();
  const auto views = json.find("views");
  if (json.is_object() && views != json.end() && views->is_array()) return json;
  log::warn(fmt::format("report: shown as missing: {}: no scores of views", path.string()));
  return Json::object();
}

// View name -> metric id -> value.
std::map<std::string, Json> scores_by_view(const Json& scores) {
  std::map<std::string, Json> by_view;
  for (const Json& view : scores.value("views", Json::array()))
    if (view.is_object() && view.value("name", Json()).is_string() &&
        view.value("metrics", Json()).is_object())
      by_view[view["name"].get<std::string>()] = view["metrics"];
  return by_view;
}

constexpr const char* kRunMeshes[] = {"mesh.ply", "mesh_transmission.ply"};

std::size_t run_steps(const fs::path& run) {
  std::size_t steps = or_warn([&] { return list_folders(run / "renders"); }).size();
  for (const char* mesh : kRunMeshes) steps += or_warn([&] { return is_file(run / mesh); });
  return steps;
}

// Share of the view that is glass; null: its data do not say.
Json glass_share(const View& view) {
  const auto mask = view.truth["glass"].values();
  if (mask.empty()) return nullptr;
  const auto glass = std::count_if(mask.begin(), mask.end(), [](float g) { return g != 0; });
  return short_number(static_cast<double>(glass) / static_cast<double>(mask.size()));
}

// One scene while it is written: what the runs rendered, what is true, where things go.
class SceneWriter {
 public:
  SceneWriter(
      const PageScene& scene,
      std::size_t index,
      const PageOptions& options,
      const fs::path& assets,
      Progress& progress
  )
      : scene_(scene), index_(index), options_(options), assets_(assets), progress_(progress) {
    load_truth();
    for (const PageRun& run : scene_.runs)
      scores_.push_back(scores_by_view(read_scores(run.folder)));
    name_views();
    if (truth_) scale_ = depth_scale(run_folders(), truth_->test);
  }

  void write() {
    Json json = {{"name", scene_.name}, {"dataset", scene_.dataset}};
    json["note"] = note_;
    json["depth_from_truth"] = scale_.from_truth;
    json["layers"] = layers_json(page_layers(), scale_);
    json["metrics"] = metric_ids();
    json["views"] = write_views();
    json["runs"] = Json::array();
    for (std::size_t run = 0; run < scene_.runs.size(); ++run)
      json["runs"].push_back(run_json(run));
    json["meshes"] = Json::array();
    add_mesh(true_mesh(truth_folder_), "Ground truth", "t0", json["meshes"]);
    write_part(fmt::format("scene_{}", index_), json);
  }

 private:
  void write_part(const std::string& name, const Json& json) const {
    write_file(assets_ / (name + ".js"), part_script(name, json));
  }

  std::vector<fs::path> run_folders() const {
    std::vector<fs::path> folders;
    for (const PageRun& run : scene_.runs) folders.push_back(run.folder);
    return folders;
  }

  // Of the first run whose data can be loaded.
  void load_truth() {
    note_ = "No run folder says which data it was scored against.";
    for (const PageRun& run : scene_.runs) {
      if (!run.spec) continue;
      try {
        truth_ = options_.load(*run.spec);
        truth_folder_ = run.spec->dataset_folder;
        note_.clear();
        return;
      } catch (const Error& error) {
        note_ = fmt::format("No reference: {}", error.what());
      }
    }
  }

  void name_views() {
    if (truth_)
      for (const View& view : truth_->test) views_.push_back(view.name);
    std::set<std::string> known(views_.begin(), views_.end());
    for (const auto& scores : scores_)
      for (const auto& [name, metrics] : scores)
        if (known.insert(name).second) views_.push_back(name);
  }

  const View* true_view(std::size_t view) const {
    return truth_ && view < truth_->test.size() ? &truth_->test[view] : nullptr;
  }

  std::vector<std::string> metric_ids() const {
    std::set<std::string> ids;
    for (const auto& scores : scores_)
      for (const auto& [name, metrics] : scores)
        for (const auto& [id, value] : metrics.items())
          if (value.is_number()) ids.insert(id);
    return {ids.begin(), ids.end()};
  }

  Json write_views() const {
    std::vector<Json> views(views_.size());
    parallel_for(views_.size(), 1, [&](std::size_t view) { views[view] = write_view(view); });
    return views;
  }

  Json write_view(std::size_t view) const {
    const View* truth = true_view(view);
    ImageSize size = truth ? truth->rgb.size() : ImageSize{};
    const LayerMaps reference = truth ? true_layers(*truth) : LayerMaps{};
    Json json = {{"name", views_[view]}, {"truth", write_pictures(reference, view, "t")}};
    Json probe = Json::object();
    for (std::size_t run = 0; run < scene_.runs.size(); ++run) {
      const fs::path folder = view_folder(scene_.runs[run].folder, views_[view]);
      const LayerMaps maps = rendered_layers(folder, truth);
      if (or_warn([&] { return is_folder(folder); })) progress_.advance();
      if (size == ImageSize{} && !maps.empty()) size = maps.begin()->second.size();
      json["runs"].push_back(write_pictures(maps, view, fmt::format("r{}", run)));
      probe["runs"].push_back(probe_values(maps, probe_step(size)));
    }
    json["size"] = {size.width, size.height};
    probe["step"] = probe_step(size);
    probe["size"] = json["size"];
    probe["truth"] = probe_values(reference, probe_step(size));
    json["glass"] = truth ? glass_share(*truth) : Json();
    probe["glass"] = truth ? probe_glass(mask_of_map(truth->truth["glass"])) : Json();
    write_part(fmt::format("probe_{}_{}", index_, view), probe);
    return json;
  }

  // Ids of the layers that have a picture.
  Json write_pictures(const LayerMaps& maps, std::size_t view, const std::string& owner) const {
    Json ids = Json::array();
    for (const PageLayer& layer : page_layers())
      if (const auto it = maps.find(layer.id); it != maps.end()) {
        const std::string name =
            fmt::format("pictures/s{}/v{}_{}_{}", index_, view, owner, layer.id);
        write_png(assets_ / (name + ".png"), layer_picture(layer, it->second, scale_));
        if (!options_.single_file) write_picture_script(name);
        ids.push_back(layer.id);
      }
    return ids;
  }

  // A page from file:// may show a PNG, but not read it; to save what it shows it loads this.
  void write_picture_script(const std::string& name) const {
    const std::string bytes = base64(read_file(assets_ / (name + ".png")));
    write_part(name, "data:image/png;base64," + bytes);
  }

  Json run_json(std::size_t i) const {
    const PageRun& run = scene_.runs[i];
    Json json = {
        {"method", run.record->cell.method},
        {"seed", run.record->cell.seed},
        {"ok", run.record->ok()},
        {"folder", run.folder.string()},
        {"warnings", run.record->warnings}};
    if (!run.record->ok()) json["failure"] = run.record->failure->message;
    json["scores"] = Json::array();
    const auto ids = metric_ids();
    for (const std::string& view : views_) json["scores"].push_back(scores_of(i, view, ids));
    json["curve"] = curve_of(run);
    json["commands"] = run_commands(run, options_);
    json["meshes"] = Json::array();
    add_mesh(run.folder / kRunMeshes[0], "mesh", fmt::format("r{}a", i), json["meshes"]);
    add_mesh(
        run.folder / kRunMeshes[1], "mesh behind glass", fmt::format("r{}b", i), json["meshes"]
    );
    return json;
  }

  // Null where the view was not scored.
  Json scores_of(std::size_t run, const std::string& view, const std::vector<std::string>& ids)
      const {
    const auto it = scores_[run].find(view);
    if (it == scores_[run].end()) return nullptr;
    Json row = Json::array();
    for (const std::string& id : ids) {
      const Json value = it->second.value(id, Json());
      row.push_back(value.is_number() ? short_number(value.get<double>()) : Json());
    }
    return row;
  }

  Json curve_of(const PageRun& run) const {
    try {
      return training_curve(run.folder / "log.jsonl");
    } catch (const Error& error) {
      log::warn(fmt::format("report: shown as missing: {}", error.what()));
      return nullptr;
    }
  }

  void add_mesh(
      const fs::path& path, const std::string& title, const std::string& owner, Json& meshes
  ) const {
    if (!or_warn([&] { return is_file(path); })) return;
    progress_.advance(owner.front() == 'r');  // the truth's is no step: no run has it
    TriangleMesh mesh;
    try {
      mesh = read_mesh(path);
    } catch (const Error& error) {
      log::warn(fmt::format("report: shown as missing: {}", error.what()));
      return;
    }
    const std::string part = fmt::format("mesh_{}_{}", index_, owner);
    write_part(part, mesh_json(with_few_faces(mesh, mesh_faces(options_))));
    meshes.push_back({{"title", title}, {"part", part}, {"faces", mesh.faces.size()}});
  }

  const PageScene& scene_;
  std::size_t index_;
  const PageOptions& options_;
  fs::path assets_, truth_folder_;
  Progress& progress_;
  std::optional<Scene> truth_;
  std::string note_;                                 // why there is no reference
  std::vector<std::map<std::string, Json>> scores_;  // of each run
  std::vector<std::string> views_;                   // those of the data first
  DepthScale scale_;
};

}  // namespace

std::vector<PageScene> page_scenes(const std::vector<Record>& records, const fs::path& folder) {
  std::vector<PageScene> scenes;
  std::map<std::pair<std::string, std::string>, std::size_t> known;
  for (const Record& record : records) {
    const auto [it, added] =
        known.emplace(std::pair(record.dataset, record.cell.scene), scenes.size());
    if (added) scenes.push_back({record.dataset, record.cell.scene, {}});
    const fs::path run = run_folder(folder, record.cell);
    scenes[it->second].runs.push_back({&record, run, spec_of(run)});
  }
  return scenes;
}

Json run_commands(const PageRun& run, const PageOptions& options) {
  Json commands = Json::array();
  const auto add = [&](const char* what, const std::vector<std::string>& words) {
    std::string command = "glint-bench";
    for (const std::string& word : words) command.append(" ").append(shell_word(word));
    commands.push_back({{"what", what}, {"command", command}});
  };
  const CellKey& cell = run.record->cell;
  std::vector<std::string> all = {
      "all",
      "--profile",
      options.profile,
      "--out",
      options.out,
      "--data",
      options.data,
      "--only",
      cell.text(),
      "--seed",
      fmt::format("{}", cell.seed),
      "--force"};
  std::vector<std::string> changes;
  if (run.spec) {
    changes = {"--iterations", fmt::format("{}", run.spec->options.iterations)};
    for (const auto& [name, value] : run.spec->config.items()) {
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      changes.insert(changes.end(), {"--set", fmt::format("{}={}", name, text)});
    }
  }
  all.insert(all.end(), changes.begin(), changes.end());
  add("cell", all);
  if (!run.spec) return commands;
  const std::string folder = run.folder.string();
  std::vector<std::string> train = {
      "train",
      "--dataset",
      run.spec->dataset_folder.string(),
      "--method",
      cell.method,
      "--seed",
      fmt::format("{}", cell.seed),
      "--run",
      folder};
  if (run.spec->max_pixels > 0)
    train.insert(train.end(), {"--max-pixels", fmt::format("{}", run.spec->max_pixels)});
  if (run.spec->image_ratio != 1)
    train.insert(train.end(), {"--image-ratio", fmt::format("{}", run.spec->image_ratio)});
  train.insert(train.end(), changes.begin(), changes.end());
  add("train", train);
  add("render", {"render", "--run", folder});
  add("eval", {"eval", "--run", folder});
  return commands;
}

std::size_t scene_steps(const PageScene& scene) {
  std::size_t steps = 0;
  for (const PageRun& run : scene.runs) steps += run_steps(run.folder);
  return steps;
}

void write_scene(
    const PageScene& scene,
    std::size_t index,
    const PageOptions& options,
    const fs::path& assets,
    Progress& progress
) {
  SceneWriter(scene, index, options, assets, progress).write();
}

}  // namespace glint
