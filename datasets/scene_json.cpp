// SPDX-License-Identifier: MIT
#include "datasets/scene_json.h"

#include <map>
#include <set>

#include "datasets/side_maps.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/json_error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

void find_side_maps(const fs::path& folder, ViewSource& view) {
  const auto find = [&](MapFiles& files, const MapRow& row, const fs::path& file) {
    if (!file.empty() && folder / file == view.counted) return;  // masks/ of what counts
    if (file.empty() || !is_folder((folder / file).parent_path())) return;
    files[row] = folder / file;
    for (const char* extension : {".exr", ".npy"})
      if (const fs::path other = fs::path(folder / file).replace_extension(extension);
          !is_there(folder / file) && is_there(other))
        files[row] = other;
  };
  for (const MapRow& row : maps()) {
    find(view.priors, row, side_prior_file(row, view.name));
    find(view.truth, row, side_truth_file(row, view.name));
  }
}

// A mask that the format itself names comes first.
void find_counted(const fs::path& folder, ViewSource& view) {
  if (const fs::path file = folder / counted_file(view.name);
      view.counted.empty() && is_there(file))
    view.counted = file;
}

// Priors of the named views that are not there are none; of other views they are missing files.
void leave_out_priors(std::set<std::string> names, const std::string& where, SceneIndex& index) {
  for (ViewSource& view : index.views) {
    if (names.erase(view.name) == 0) continue;
    view.priors.for_each([](const MapRow&, fs::path& file) {
      if (!is_there(file)) file.clear();
    });
  }
  const std::string unknown = names.empty() ? "" : *names.begin();
  GLINT_CHECK(
      unknown.empty(), kBadReference, "{}: without_priors: no view is called {}", where, unknown
  );
}

// Of what scene.json says of priors by other programs.
PriorOptions read_priors(const Json& json, const fs::path& folder, const std::string& where) {
  PriorOptions priors;
  priors.axes = json.value("prior_axes", "");
  priors.depth = json.value("prior_depth", "");
  priors.overlap = json.value("prior_overlap", -1);
  priors.albedo_from_basecolor = json.value("albedo_from_basecolor", false);
  try {
    check_prior_options(priors, where);
  } catch (const Error& error) {  // of the data, not of who asks
    throw Error(ExitCode::kBadReference, error.what());
  }
  const fs::path place = fs::path(with_slashes(json.value("prior_folder", ""))).lexically_normal();
  if (place.empty()) return priors;
  GLINT_CHECK(
      place.is_relative() && *place.begin() != "..",
      kBadReference,
      "{}: prior_folder: '{}' leaves the scene's folder; move the priors into it, or name another "
      "place by --priors",
      where,
      place.string()
  );
  priors.folder = (folder / place).string();
  return priors;
}

void split_by_names(const Json& test_views, const std::string& where, SceneIndex& index) {
  const std::string unknown = hold_out(test_views.get<std::set<std::string>>(), index.views);
  GLINT_CHECK(
      unknown.empty(), kBadReference, "{}: test_views: no view is called {}", where, unknown
  );
  index.split_rule = "test_views of scene.json";
}

void read_depth_scale(const Json& json, const std::string& where, SceneIndex& index) {
  const double scale = json.value("depth_scale", 1e-3);
  GLINT_CHECK(
      scale > 0 && scale < 1e3,
      kBadReference,
      "{}: depth_scale is {}; expected the metres of a step of 16-bit depth, such as 0.001",
      where,
      scale
  );
  for (ViewSource& view : index.views) view.depth_scale = scale;
}

void read_alpha_use(const Json& json, const std::string& where, SceneIndex& index) {
  if (json.contains("alpha"))
    set_alpha_use(json["alpha"].get<std::string>(), where + ": alpha", index);
}

}  // namespace

void set_alpha_use(const std::string& use, const std::string& where, SceneIndex& index) {
  const std::map<std::string, AlphaUse> uses{
      {"black", AlphaUse::kBlack},
      {"white", AlphaUse::kWhite},
      {"mask", AlphaUse::kMask},
      {"stored", AlphaUse::kStored}};
  GLINT_CHECK(
      uses.contains(use),
      kBadReference,
      "{} is '{}'; expected black or white (what transparent pictures lie on), mask (what is "
      "transparent does not count) or stored (colours as in the file)",
      where,
      use
  );
  for (ViewSource& view : index.views) view.alpha = uses.at(use);
}

void read_scene_json(const fs::path& folder, SceneIndex& index) {
  const fs::path path = folder / "scene.json";
  if (!is_there(path)) return;
  try {
    const std::string text = read_text(path);
    check_json_text(text, path);
    const Json json = Json::parse(text);
    index.name = json.value("name", index.name);
    const std::string why = why_no_folder_name(index.name);
    GLINT_CHECK(
        why.empty(),
        kBadReference,
        "{}: name: '{}' {}; results lie in a folder of that name, give a plain one",
        path.string(),
        index.name,
        why
    );
    index.dataset = json.value("dataset", index.dataset);
    index.spec_hash = json.value("hash", index.spec_hash);
    index.simulated_priors = json.value("simulated_priors", false);
    if (json.contains("test_views")) split_by_names(json["test_views"], path.string(), index);
    read_depth_scale(json, path.string(), index);
    read_alpha_use(json, path.string(), index);
    for (ViewSource& view : index.views) find_counted(folder, view);
    if (json.value("side_maps", false))
      for (ViewSource& view : index.views) find_side_maps(folder, view);
    index.stated_priors = read_priors(json, folder, path.string());
    if (json.contains("without_priors"))
      leave_out_priors(json["without_priors"], path.string(), index);
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        ExitCode::kBadReference,
        fmt::format("{}: {}; write it again", path.string(), json_error(error))
    );
  }
}

}  // namespace glint
