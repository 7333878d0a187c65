// SPDX-License-Identifier: MIT
#include "reports/verbs/dataset_manifest.h"

#include "datasets/scene_index.h"
#include "reports/records/manifest.h"
#include "reports/verbs/listing.h"
#include "reports/verbs/print_findings.h"

namespace glint {
namespace {

struct PlacedManifest {
  const Manifest* manifest = nullptr;
  fs::path data;
};

PlacedManifest manifest_called(const CommonOptions& common, const std::string& name) {
  if (const Manifest* manifest = find_manifest(name)) return {manifest, common.data};
  std::error_code code;
  if (!fs::is_directory(name, code)) return {};
  const fs::path folder = fs::absolute(fs::path(name) / ".").lexically_normal().parent_path();
  return {find_manifest(folder.filename().string()), folder.parent_path()};
}

// Scenes that are missing are one finding of the whole.
std::vector<Finding> findings_of(
    const PlacedManifest& placed, const std::vector<ManifestSceneState>& states
) {
  std::vector<Finding> findings;
  for (const ManifestSceneState& state : states)
    findings.insert(findings.end(), state.findings.begin(), state.findings.end());
  const std::string missing = missing_scenes_text(*placed.manifest, placed.data);
  if (!missing.empty())
    findings.push_back({"missing-scene", (placed.data / placed.manifest->id).string(), missing});
  return findings;
}

std::string hash_text(const ManifestSceneState& state) {
  if (state.hash.empty()) return "";
  if (state.first_hash.empty()) return state.hash + ", first seen now";
  return state.hash + (state.first_hash == state.hash ? ", as first seen" : ", changed");
}

std::string size_text(const ManifestSceneState& state) {
  if (state.stored_size.empty()) return "";
  return fmt::format("{} stored, {} used", state.stored_size, state.loaded_size);
}

std::string views_text(const ManifestSceneState& state) {
  const std::string text = fmt::format("{} train, {} test", state.train, state.test);
  return state.with_depth == 0 ? text
                               : fmt::format("{}, {} with true depth", text, state.with_depth);
}

std::string states_text(
    const PlacedManifest& placed, const std::vector<ManifestSceneState>& states
) {
  const Manifest& manifest = *placed.manifest;
  std::string text = fmt::format(
      "{} ({}): {}\nfrom {}\nimages: {} of the stored sides, area average\n",
      manifest.id,
      manifest.title,
      manifest.about,
      manifest.source,
      manifest.image_ratio
  );
  std::vector<std::vector<std::string>> lines;
  for (const ManifestSceneState& state : states) {
    std::vector<std::string> line{state.name, "missing", "", ""};
    if (state.there) line = {state.name, views_text(state), size_text(state), hash_text(state)};
    lines.push_back(std::move(line));
  }
  return text + listing(lines);
}

Json states_json(const PlacedManifest& placed, const std::vector<ManifestSceneState>& states) {
  Json scenes = Json::array();
  for (const ManifestSceneState& state : states)
    scenes.push_back(
        {{"name", state.name},
         {"folder", state.folder.string()},
         {"there", state.there},
         {"train_views", state.train},
         {"test_views", state.test},
         {"test_views_with_true_depth", state.with_depth},
         {"stored_size", state.stored_size},
         {"used_size", state.loaded_size},
         {"hash", state.hash},
         {"first_hash", state.first_hash}}
    );
  return {
      {"dataset", placed.manifest->id},
      {"image_ratio", placed.manifest->image_ratio},
      {"resize_filter", "area"},
      {"scenes", scenes}};
}

struct Examined {
  PlacedManifest placed;
  std::vector<ManifestSceneState> states;
  std::vector<Finding> findings;
};

std::optional<Examined> examine(const CommonOptions& common, const std::string& name) {
  Examined examined{manifest_called(common, name), {}, {}};
  if (examined.placed.manifest == nullptr) return std::nullopt;
  examined.states = examine_manifest(*examined.placed.manifest, examined.placed.data, true);
  examined.findings = findings_of(examined.placed, examined.states);
  return examined;
}

}  // namespace

std::optional<int> show_manifest(const CommonOptions& common, const std::string& name) {
  const auto examined = examine(common, name);
  if (!examined) return std::nullopt;
  Json json = states_json(examined->placed, examined->states);
  json["findings"] = findings_json(examined->findings);
  if (common.json)
    print_json(json);
  else
    print_text(states_text(examined->placed, examined->states) + findings_text(examined->findings));
  return 0;
}

std::optional<int> check_manifest(const CommonOptions& common, const std::string& name) {
  const auto examined = examine(common, name);
  if (!examined) return std::nullopt;
  return print_findings(common, name, examined->findings, "as published");
}

}  // namespace glint
