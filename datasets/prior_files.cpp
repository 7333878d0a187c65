// SPDX-License-Identifier: MIT
#include "datasets/prior_files.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

const std::vector<std::string> kMapFiles{".png", ".jpg", ".jpeg", ".exr", ".npy", ".tif", ".tiff"};

// Other names of the folders of a prior (MapRow::prior).
const std::multimap<std::string, std::string> kAliases{
    {"normal", "normals"},
    {"depth", "depths"},
    {"diffuse_albedo", "albedo"},
    {"basecolor", "base_color"},
    {"metallic", "metallics"},
};

std::vector<std::string> names_of_pass(const std::string& pass) {
  std::vector<std::string> names{pass};
  const auto [begin, end] = kAliases.equal_range(pass);
  for (auto it = begin; it != end; ++it) names.push_back(it->second);
  return names;
}

// Where the maps of a pass lie; empty: nowhere. A folder that is itself called like the pass is
// one.
fs::path folder_of_pass(const fs::path& folder, const std::string& pass) {
  for (const std::string& name : names_of_pass(pass))
    if (is_folder(folder / name)) return folder / name;
  for (const std::string& name : names_of_pass(pass))
    if (folder_name(folder) == name) return folder;
  return {};
}

// Names under which files of a view may lie: its own, and its picture's.
std::vector<std::string> names_of_view(const ViewSource& view) {
  std::vector<std::string> names{view.name};
  if (const std::string stem = view.image.stem().string(); stem != view.name) names.push_back(stem);
  std::erase_if(names, [](const std::string& name) { return !why_no_folder_name(name).empty(); });
  return names;
}

// Empty: there is none.
fs::path file_by_name(const fs::path& pass_folder, const ViewSource& view) {
  if (const fs::path frames = pass_folder / view.name;
      why_no_folder_name(view.name).empty() && is_folder(frames))
    if (const auto files = list_files(frames, kMapFiles); !files.empty()) return files.front();
  for (const std::string& name : names_of_view(view))
    for (const std::string& extension : kMapFiles)
      if (const fs::path file = pass_folder / (name + extension); is_file(file)) return file;
  return {};
}

// The files of one pass, one a view; all empty: there is no such pass.
std::vector<fs::path> files_of_pass(
    const fs::path& folder, const std::string& pass, const std::vector<ViewSource>& views
) {
  std::vector<fs::path> files(views.size());
  const fs::path place = folder_of_pass(folder, pass);
  if (place.empty()) return files;
  std::transform(views.begin(), views.end(), files.begin(), [&](const ViewSource& view) {
    return file_by_name(place, view);
  });
  return files;
}

std::size_t count_files(const std::vector<fs::path>& files) {
  return static_cast<std::size_t>(
      std::count_if(files.begin(), files.end(), [](const fs::path& file) { return !file.empty(); })
  );
}

// StableNormal's pictures have axes of their own; arrays and floats are taken for ours.
PriorReading documented_for(const fs::path& folder, const fs::path& normal) {
  const std::string extension = normal.extension().string();
  const bool picture = extension == ".png" || extension == ".jpg" || extension == ".jpeg";
  const bool stable = folder_name(folder_of_pass(folder, "normal")) == "normals" && picture;
  return {stable ? PriorAxes::kStableNormal : PriorAxes::kOpencv, PriorDepth::kLinear};
}

bool any_view_has(const std::vector<ViewSource>& views, const MapRow& row) {
  return std::any_of(views.begin(), views.end(), [&](const ViewSource& view) {
    return view.priors.has(row);
  });
}

// `missing_only`: kinds that no view has yet.
FoundPriors find_priors_by_name(
    const fs::path& folder, const std::vector<ViewSource>& views, bool missing_only
) {
  FoundPriors found(views.size());
  found.program = folder_name(folder) + "/";
  std::vector<std::string> passes;
  for (const MapRow& row : maps()) {
    if (row.prior.empty() || (missing_only && any_view_has(views, row))) continue;
    const auto files = files_of_pass(folder, std::string(row.prior), views);
    const auto first = std::find_if(files.begin(), files.end(), [](const fs::path& file) {
      return !file.empty();
    });
    if (first == files.end()) continue;
    if (row.id == "normal") found.documented = documented_for(folder, *first);
    for (std::size_t i = 0; i < files.size(); ++i)
      if (!files[i].empty()) found.files[i][row] = files[i];
    passes.push_back(fmt::format("{} ({} views)", row.prior, count_files(files)));
  }
  found.metallic = files_of_pass(folder, "metallic", views);
  if (!passes.empty())
    found.notes.push_back(fmt::format("priors of {}: {}", found.program, fmt::join(passes, ", ")));
  return found;
}

bool has_kind(const FoundPriors& found, const MapRow& row) {
  return std::any_of(found.files.begin(), found.files.end(), [&](const MapFiles& files) {
    return files.has(row);
  });
}

// `replace`: also kinds that views have already. Returns whether anything was taken.
bool take(const FoundPriors& found, bool replace, SceneIndex& index) {
  bool any = false;
  for (const MapRow& row : maps()) {
    if (!has_kind(found, row) || (!replace && any_view_has(index.views, row))) continue;
    any = true;
    if (row.id == "normal") index.documented_priors.axes = found.documented.axes;
    if (row.id == "depth") index.documented_priors.depth = found.documented.depth;
    for (std::size_t i = 0; i < index.views.size(); ++i) {
      ViewSource& view = index.views[i];
      view.priors[row] = found.files[i][row];
      view.prior_programs[row] = view.priors.has(row) ? found.program : "";
    }
  }
  if (!any) return false;
  for (std::size_t i = 0; i < index.views.size(); ++i)
    if (!found.metallic[i].empty()) index.views[i].metallic = found.metallic[i];
  index.prior_notes.insert(index.prior_notes.end(), found.notes.begin(), found.notes.end());
  return true;
}

void take_from_folder(const fs::path& folder, int overlap, SceneIndex& index) {
  GLINT_CHECK(
      is_folder(folder), kBadReference, "{}: priors: no such folder; name one", folder.string()
  );
  if (const auto chunked = find_chunked_priors(folder, index, overlap)) {
    take(*chunked, true, index);
    return;
  }
  GLINT_CHECK(
      take(find_priors_by_name(folder, index.views, false), true, index),
      kBadReference,
      "{}: no priors of the scene's views; expected CCCC.FFFF.normal.png and such, or "
      "normal/<view>.png, depth/<view>.npy, ... with views called as '{}'",
      folder.string(),
      index.views.empty() ? "" : index.views.front().name
  );
}

// An albedo from the base colour is no file: the reader makes it, where it is asked for.
void settle_albedo(bool from_basecolor, SceneIndex& index) {
  const MapRow &albedo = MapId("albedo").row(), &basecolor = MapId("basecolor").row();
  if (any_view_has(index.views, albedo) || !any_view_has(index.views, basecolor)) {
    for (ViewSource& view : index.views) view.metallic.clear();
    return;
  }
  if (!from_basecolor) {
    for (ViewSource& view : index.views) view.metallic.clear();
    index.prior_notes.push_back(
        "no diffuse_albedo: what needs it is off (albedo_from_basecolor takes the base colour)"
    );
    return;
  }
  const bool metallic = std::any_of(index.views.begin(), index.views.end(), [](const auto& view) {
    return !view.metallic.empty();
  });
  for (ViewSource& view : index.views) {
    if (metallic && view.metallic.empty()) continue;
    view.priors[albedo] = view.priors[basecolor];
    view.prior_programs[albedo] = view.prior_programs[basecolor];
  }
  index.prior_notes.push_back(fmt::format(
      "albedo made of the base colour{}; glass reads bright in it, so thresholds of the albedo may "
      "not fit",
      metallic ? " x (1 - metallic)" : ", no metallic pass"
  ));
}

}  // namespace

PriorOptions merged_priors(const PriorOptions& given, const PriorOptions& stated) {
  PriorOptions merged = given;
  if (merged.folder.empty()) merged.folder = stated.folder;
  if (merged.axes.empty()) merged.axes = stated.axes;
  if (merged.depth.empty()) merged.depth = stated.depth;
  if (merged.overlap < 0) merged.overlap = stated.overlap;
  merged.albedo_from_basecolor = given.albedo_from_basecolor || stated.albedo_from_basecolor;
  return merged;
}

void attach_priors(const fs::path& folder, const PriorOptions& options, SceneIndex& index) {
  const PriorOptions merged = merged_priors(options, index.stated_priors);
  check_prior_options(options, "priors");
  if (!merged.folder.empty()) take_from_folder(merged.folder, merged.overlap, index);
  if (is_folder(folder / "diffrens"))
    take(find_priors_by_name(folder / "diffrens", index.views, true), false, index);
  if (is_folder(folder / "normals"))
    take(find_priors_by_name(folder / "normals", index.views, true), false, index);
  settle_albedo(merged.albedo_from_basecolor, index);
}

}  // namespace glint
