// SPDX-License-Identifier: MIT
#include "reports/run/records/manifest.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "datasets/dataset.h"
#include "datasets/released_truth.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/sha256.h"
#include "glint/scene/image_files.h"
#include "reports/run/records/embedded.h"
#include "reports/run/records/stage_files.h"

namespace glint {
namespace {

Manifest parse_manifest(const std::string& id) {
  const std::string where = fmt::format("manifest {}", id);
  Manifest manifest;
  const std::string_view text = embedded_files().at(fmt::format("manifests/{}.toml", id));
  config_from_json(manifest, json_from_toml(text, where), where);
  manifest.id = id;
  for (const Json& json : manifest.scenes_json) {
    ManifestScene scene;
    config_from_json(scene, json, where + " scenes");
    manifest.scenes.push_back(scene);
  }
  return manifest;
}

std::vector<Manifest> parse_manifests() {
  std::vector<Manifest> parsed;
  for (const std::string& id : embedded_names("manifests")) parsed.push_back(parse_manifest(id));
  return parsed;
}

// ---------------------------------------------------------------- hashes at first sight

fs::path hashes_file(const Manifest& manifest, const fs::path& data_folder) {
  return data_folder / (manifest.id + ".hashes.json");
}

// What a release has; priors and what people add later do not change it.
std::string hash_of_scene(const fs::path& folder, const fs::path& data_folder) {
  std::string text;
  for (const char* part : {"images", "intri.yml", "extri.yml", "sparse", "transforms.json"})
    if (is_there(folder / part))
      text += fmt::format("{} {}\n", part, content_hash(folder / part, data_folder / ".hashes"));
  return sha256(text).substr(0, 16);
}

void compare_hashes(
    const Manifest& manifest, const fs::path& data_folder, std::vector<ManifestSceneState>& states
) {
  const fs::path file = hashes_file(manifest, data_folder);
  Json known = is_there(file) ? read_json_object(file) : Json::object();
  const Json before = known;
  for (ManifestSceneState& state : states) {
    if (!state.there) continue;
    state.hash = hash_of_scene(state.folder, data_folder);
    const auto first = known.find(state.name);
    if (first == known.end() || !first->is_string()) {
      known[state.name] = state.hash;
      continue;
    }
    state.first_hash = first->get<std::string>();
    if (state.first_hash != state.hash)
      state.findings.push_back(
          {"manifest-hash",
           state.folder.string(),
           fmt::format(
               "cameras, points or pictures are not what they were when first seen (hash {}, now "
               "{}); "
               "bring the first data back, or remove {} if these are meant",
               state.first_hash,
               state.hash,
               file.string()
           )}
      );
  }
  if (known != before) write_file(file, known.dump(1) + "\n");
}

// ---------------------------------------------------------------- a scene against its manifest

std::string size_text(ImageSize size) { return fmt::format("{}x{}", size.width, size.height); }

// Of the first picture below images/; empty: none whose header says it.
ImageSize first_picture_size(const fs::path& folder) {
  for (const fs::path& file : list_files_below(folder / "images")) {
    const std::string extension = file.extension().string();
    if (std::ranges::count(kPictureExtensions, extension) > 0) return read_image_size(file);
  }
  return {};
}

void compare_counts(const ManifestScene& expected, ManifestSceneState& state) {
  const auto train = static_cast<std::size_t>(expected.train);
  const auto test = static_cast<std::size_t>(expected.test);
  if (state.train == train && state.test == test) return;
  state.findings.push_back(
      {"manifest-views",
       state.folder.string(),
       fmt::format(
           "{} training and {} test views; the release has {} and {}: views are missing, or it is "
           "another scene",
           state.train,
           state.test,
           expected.train,
           expected.test
       )}
  );
}

void compare_extent(const ManifestScene& expected, const Scene& found, ManifestSceneState& state) {
  constexpr double kSame = 0.02;        // relative
  constexpr double kNearBounds = 0.05;  // metres
  const auto scale = static_cast<double>(found.spatial_scale);
  if (std::abs(scale - expected.spatial_scale) > kSame * expected.spatial_scale)
    state.findings.push_back(
        {"manifest-extent",
         state.folder.string(),
         fmt::format(
             "extent of the training cameras {:.4f}, the release has {:.4f}: other poses or units",
             scale,
             expected.spatial_scale
         )}
    );
  if (expected.bounds_min.size() != 3 || expected.bounds_max.size() != 3) return;
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const auto low = static_cast<double>(found.bounds_min[axis]);
    const auto high = static_cast<double>(found.bounds_max[axis]);
    most = std::max(
        {most, std::abs(low - expected.bounds_min[i]), std::abs(high - expected.bounds_max[i])}
    );
  }
  if (most > kNearBounds)
    state.findings.push_back(
        {"manifest-bounds",
         state.folder.string(),
         fmt::format("bounds of the points are up to {:.3f} off the release's: other points", most)}
    );
}

std::size_t count_with_depth(const fs::path& folder, const std::vector<View>& views) {
  const fs::path released = released_truth(folder);
  return static_cast<std::size_t>(std::count_if(views.begin(), views.end(), [&](const View& view) {
    return !released_depth(released, view.name).empty() ||
           is_there(folder / "gt" / true_map_file(MapId("depth").row(), view.name));
  }));
}

ManifestSceneState examine_scene(
    const Manifest& manifest, const ManifestScene& scene, const fs::path& data_folder
) {
  ManifestSceneState state;
  state.name = scene.name;
  state.folder = manifest_scene_folder(manifest, scene, data_folder);
  state.there = is_there(state.folder);
  if (!state.there) return state;
  try {
    LoadOptions options;
    options.test_every = manifest.test_every;
    options.image_ratio = manifest.image_ratio;
    const LoaderSpec& loader = find_loader(state.folder);
    const Scene found =
        loader.outline ? loader.outline(state.folder, options) : loader.load(state.folder, options);
    state.train = found.train.size();
    state.test = found.test.size();
    state.with_depth = count_with_depth(state.folder, found.test);
    compare_counts(scene, state);
    compare_extent(scene, found, state);
    if (const ImageSize stored = first_picture_size(state.folder); stored.width > 0) {
      state.stored_size = size_text(stored);
      state.loaded_size = size_text(
          {static_cast<int>(manifest.image_ratio * stored.width),
           static_cast<int>(manifest.image_ratio * stored.height)}
      );
    }
  } catch (const OutOfMemory&) {
    throw;
  } catch (const Error& error) {
    state.findings.push_back(make_finding("unreadable-file", state.folder.string(), error.what()));
  }
  return state;
}

}  // namespace

const std::vector<Manifest>& manifests() {
  static const std::vector<Manifest> all = parse_manifests();
  return all;
}

const Manifest* find_manifest(const std::string& id) {
  const auto found = std::find_if(manifests().begin(), manifests().end(), [&](const Manifest& m) {
    return m.id == id;
  });
  return found == manifests().end() ? nullptr : &*found;
}

fs::path manifest_scene_folder(
    const Manifest& manifest, const ManifestScene& scene, const fs::path& data_folder
) {
  const fs::path full = data_folder / manifest.id / scene.folder;
  const fs::path cut = data_folder / manifest.id / scene.name;
  return !is_there(full) && is_there(cut) ? cut : full;
}

std::vector<ManifestSceneState> examine_manifest(
    const Manifest& manifest, const fs::path& data_folder, bool with_hashes
) {
  std::vector<ManifestSceneState> states;
  for (const ManifestScene& scene : manifest.scenes)
    states.push_back(examine_scene(manifest, scene, data_folder));
  if (with_hashes) compare_hashes(manifest, data_folder, states);
  return states;
}

std::string missing_scenes_text(const Manifest& manifest, const fs::path& data_folder) {
  std::vector<std::string> missing;
  for (const ManifestScene& scene : manifest.scenes)
    if (!is_there(manifest_scene_folder(manifest, scene, data_folder)))
      missing.push_back(scene.name);
  if (missing.empty()) return {};
  return fmt::format(
      "{}: {} of {} scenes are missing ({}); from {}; each goes to {}",
      manifest.id,
      missing.size(),
      manifest.scenes.size(),
      fmt::join(missing, ", "),
      manifest.source,
      (data_folder / manifest.id / manifest.scenes.front().folder).string()
  );
}

}  // namespace glint
