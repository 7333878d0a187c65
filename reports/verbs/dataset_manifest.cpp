// SPDX-License-Identifier: MIT
#include "glint/core/presence.h"
#include "reports/verbs/dataset_parts.h"

#include "datasets/scene_index.h"
#include "glint/core/rows.h"
#include "reports/run/records/manifest.h"
#include "reports/verbs/print_findings.h"

namespace glint {
namespace {

struct PlacedManifest {
  const Manifest* manifest = nullptr;
  fs::path data;
};

PlacedManifest manifest_called(const CommonOptions& common, const std::string& name) {
  if (const Manifest* manifest = find_manifest(name)) return {manifest, common.data};
  if (!is_folder(name)) return {};
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

Rows rows_of(const std::vector<ManifestSceneState>& states) {
  Rows rows(
      {{"name"}, {""}, {""}, {""}},
      "folder there train_views test_views test_views_with_true_depth stored_size used_size hash "
      "first_hash"
  );
  for (const ManifestSceneState& state : states)
    rows.add(
        {state.name,
         state.there ? views_text(state) : "missing",
         size_text(state),
         hash_text(state),
         state.folder.string(),
         state.there,
         state.train,
         state.test,
         state.with_depth,
         state.stored_size,
         state.loaded_size,
         state.hash,
         state.first_hash}
    );
  return rows;
}

std::string heading_of(const Manifest& manifest) {
  return fmt::format(
      "{} ({}): {}\nfrom {}\nimages: {} of the stored sides, area average\n",
      manifest.id,
      manifest.title,
      manifest.about,
      manifest.source,
      manifest.image_ratio
  );
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
  const Manifest& manifest = *examined->placed.manifest;
  const Rows rows = rows_of(examined->states);
  print_result(
      common,
      {{"dataset", manifest.id},
       {"image_ratio", manifest.image_ratio},
       {"resize_filter", "area"},
       {"scenes", rows.json()},
       {"findings", findings_json(examined->findings)}},
      heading_of(manifest) + rows.text() + findings_text(examined->findings)
  );
  return 0;
}

std::optional<int> check_manifest(const CommonOptions& common, const std::string& name) {
  const auto examined = examine(common, name);
  if (!examined) return std::nullopt;
  return print_findings(common, name, examined->findings, "as published");
}

}  // namespace glint
