// SPDX-License-Identifier: MIT
#include "datasets/dataset.h"

#include <fmt/ranges.h>
#include <algorithm>
#include <set>

#include "glint/core/error.h"

namespace glint {
namespace {

std::vector<LoaderSpec>& registry() {
  static std::vector<LoaderSpec> loaders;
  return loaders;
}

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

std::string format_vector(Vec3f v) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", v.x, v.y, v.z);
}

}  // namespace

bool register_loader(LoaderSpec spec, const char* source) {
  spec.source = source;
  registry().push_back(std::move(spec));
  return true;
}

const std::vector<LoaderSpec>& loader_registry() { return registry(); }

const LoaderSpec& find_loader(const fs::path& folder) {
  std::error_code code;
  GLINT_CHECK(
      fs::exists(folder, code), kBadReference, "{}: no such folder or file", folder.string()
  );
  // Registration order depends on the linker; names do not.
  const LoaderSpec* found = nullptr;
  std::string known;
  for (const LoaderSpec& loader : registry()) {
    known += fmt::format("\n  {}: {}", loader.name, loader.looks_for);
    if (loader.can_load(folder) && (found == nullptr || loader.name < found->name)) found = &loader;
  }
  GLINT_CHECK(
      found != nullptr,
      kBadReference,
      "{}: no dataset that a loader knows. Loaders and what they look for:{}",
      folder.string(),
      known
  );
  return *found;
}

Scene load_scene(const fs::path& folder, const LoadOptions& options) {
  return find_loader(folder).load(folder, options);
}

std::vector<Finding> check_dataset(const fs::path& folder) {
  const LoaderSpec& loader = find_loader(folder);
  try {
    if (loader.check) return loader.check(folder);
    loader.load(folder, {});
    return {};
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
  return text;
}

}  // namespace glint
