// SPDX-License-Identifier: MIT
#include "datasets/dataset.h"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <set>

#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

std::string size_range(const Scene& scene) {
  std::set<std::pair<int, int>> sizes;
  for (const std::vector<View>* views : {&scene.train, &scene.test})
    for (const View& view : *views) sizes.emplace(view.camera.width, view.camera.height);
  std::string text;
  for (const auto& size : sizes)
    text += fmt::format("{}{} x {}", text.empty() ? "" : ", ", size.first, size.second);
  return text.empty() ? "none" : text;
}

// "normal (64 views), depth (63 views)": the maps that views have.
std::string describe_maps(const std::vector<View>& views, MapSet View::*set) {
  std::string text;
  for (const MapRow& row : maps()) {
    const auto count = std::count_if(views.begin(), views.end(), [&](const View& view) {
      return (view.*set).has(row);
    });
    if (count > 0) text += fmt::format("{}{} ({} views)", text.empty() ? "" : ", ", row.id, count);
  }
  return text.empty() ? "none" : text;
}

struct Candidate {
  const LoaderSpec* loader;
  LoaderMatch match;
};

std::string list_loaders() {
  std::string text;
  for (const auto& [name, loader] : Registry<LoaderSpec>::all())
    text += fmt::format("\n  {}: {}", name, loader.looks_for);
  return text;
}

const LoaderSpec& loader_called(const std::string& id) {
  const auto& loaders = Registry<LoaderSpec>::all();
  if (const auto found = loaders.find(id); found != loaders.end()) return found->second;
  throw Error(
      ExitCode::kUsage, fmt::format("loader {}: no such loader. There are:{}", id, list_loaders())
  );
}

// Several only when they are as sure as each other; none when no loader knows the folder.
std::vector<Candidate> surest_loaders(const fs::path& folder) {
  std::vector<Candidate> surest;
  for (const auto& [name, loader] : Registry<LoaderSpec>::all()) {
    LoaderMatch match = loader.match(folder);
    const Sureness best = surest.empty() ? Sureness::kNone : surest.front().match.sureness;
    if (match.sureness > best) surest.clear();
    if (match.sureness >= best && match.sureness != Sureness::kNone)
      surest.push_back({&loader, std::move(match)});
  }
  return surest;
}

// A folder that may not be listed or entered looks as if nothing were in it.
void check_may_enter(const fs::path& folder) {
  const bool denied = is_folder(folder) &&
                      ::faccessat(AT_FDCWD, folder.c_str(), R_OK | X_OK, AT_EACCESS) != 0 &&
                      errno == EACCES;
  GLINT_CHECK(
      !denied,
      kEnvironment,
      "{}: permission denied; let this user list and enter the folder",
      folder.string()
  );
}

[[noreturn]] void throw_tie(const fs::path& folder, const std::vector<Candidate>& surest) {
  std::string found, options;
  for (const Candidate& candidate : surest) {
    found += fmt::format("\n  {}: {}", candidate.loader->name, candidate.match.reason);
    options += fmt::format("{}{}", options.empty() ? "" : " or ", candidate.loader->name);
  }
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: several loaders know it:{}\nSay which with --loader ({}) of `dataset info`, "
          "`check`, `pack` and `export`, or with the field loader of a profile's scene; other "
          "verbs "
          "take the file that `dataset pack` writes. Or move the files that do not belong to it "
          "away",
          folder.string(),
          found,
          options
      )
  );
}

std::string format_vector(Vec3f v) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", v.x, v.y, v.z);
}

}  // namespace

const LoaderSpec& find_loader(const fs::path& folder, const std::string& id) {
  check_exists(folder, "folder or file");
  if (!id.empty()) return loader_called(id);
  check_may_enter(folder);
  const std::vector<Candidate> surest = surest_loaders(folder);
  GLINT_CHECK(
      !surest.empty(),
      kBadReference,
      "{}: no dataset that a loader knows. Loaders and what they look for:{}",
      folder.string(),
      list_loaders()
  );
  if (surest.size() > 1) throw_tie(folder, surest);
  return *surest.front().loader;
}

Scene load_scene(const fs::path& folder, const LoadOptions& options) {
  return find_loader(folder, options.loader).load(folder, options);
}

std::vector<Finding> check_dataset(const fs::path& folder, const LoadOptions& options) {
  const LoaderSpec& loader = find_loader(folder, options.loader);
  try {
    if (loader.check) return loader.check(folder, options);
    if (!loader.load(folder, options).test.empty()) return {};
    return {Finding{
        "no-test-views",
        folder.string(),
        "no test views, so that nothing of it is scored; pack a folder that has some"}};
  } catch (const Error& error) {
    if (error.code() == ExitCode::kEnvironment) throw;
    return {make_finding("unreadable-file", folder.string(), error.what())};
  }
}

std::string describe_scene(const Scene& scene) {
  const std::size_t views = scene.train.size() + scene.test.size();
  std::string text = fmt::format("scene          {}\n", scene.name);
  text += fmt::format("dataset        {}\n", scene.dataset);
  text += fmt::format("hash           {}\n", scene.spec_hash);
  text += fmt::format(
      "views          {} ({} train, {} test)\n", views, scene.train.size(), scene.test.size()
  );
  text += fmt::format("image size     {}\n", size_range(scene));
  text += fmt::format(
      "priors         {}{}\n",
      describe_maps(scene.train, &View::priors),
      scene.simulated_priors ? ", simulated" : ""
  );
  text += fmt::format("ground truth   {}\n", describe_maps(scene.test, &View::truth));
  text += fmt::format("points         {}\n", scene.points.positions.size());
  text += fmt::format(
      "bounds         {} to {}\n", format_vector(scene.bounds_min), format_vector(scene.bounds_max)
  );
  text += fmt::format("camera extent  {:.4f}\n", scene.spatial_scale);
  for (std::size_t i = 0; i < scene.data_notes.size(); ++i)
    text += fmt::format("{:<15}{}\n", i == 0 ? "notes" : "", scene.data_notes[i]);
  return text;
}

}  // namespace glint
