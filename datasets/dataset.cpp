// SPDX-License-Identifier: MIT
#include "datasets/dataset.h"

#include <fmt/ranges.h>
#include <algorithm>
#include <set>

#include "glint/core/error.h"

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
class MapCounter {
 public:
  void count(const char* name, bool present) {
    auto it = std::find_if(counts_.begin(), counts_.end(), [&](const auto& c) {
      return c.first == name;
    });
    if (it == counts_.end()) it = counts_.insert(counts_.end(), {name, 0});
    it->second += present ? 1 : 0;
  }
  std::string text() const {
    std::string text;
    for (const auto& entry : counts_)
      if (entry.second > 0)
        text += fmt::format("{}{} ({} views)", text.empty() ? "" : ", ", entry.first, entry.second);
    return text.empty() ? "none" : text;
  }

 private:
  std::vector<std::pair<std::string, int>> counts_;
};

std::string describe_priors(const Scene& scene) {
  MapCounter counter;
  for (const View& view : scene.train) {
    counter.count("normal", !view.priors.normal.empty());
    counter.count("depth", !view.priors.depth.empty());
    counter.count("albedo", !view.priors.albedo.empty());
    counter.count("basecolor", !view.priors.basecolor.empty());
  }
  return counter.text() + (scene.simulated_priors ? ", simulated" : "");
}

std::string describe_truth(const Scene& scene) {
  MapCounter counter;
  for (const View& view : scene.test) {
    counter.count("depth", !view.truth.depth.empty());
    counter.count("normal", !view.truth.normal.empty());
    counter.count("albedo", !view.truth.albedo.empty());
    counter.count("glass", !view.truth.glass.empty());
    counter.count("depth behind glass", !view.truth.behind_depth.empty());
    counter.count("normal behind glass", !view.truth.behind_normal.empty());
    counter.count("transmitted", !view.truth.transmitted.empty());
    counter.count("reflected", !view.truth.reflected.empty());
  }
  return counter.text();
}

std::string format_vector(Vec3f v) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", v.x, v.y, v.z);
}

}  // namespace

const LoaderSpec& find_loader(const fs::path& folder) {
  std::error_code code;
  GLINT_CHECK(
      fs::exists(folder, code), kBadReference, "{}: no such folder or file", folder.string()
  );
  const LoaderSpec* found = nullptr;
  std::string known;
  for (const auto& [id, loader] : Registry<LoaderSpec>::all()) {
    known += fmt::format("\n  {}: {}", loader.name, loader.looks_for);
    if (found == nullptr && loader.can_load(folder)) found = &loader;
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
  text += fmt::format("priors         {}\n", describe_priors(scene));
  text += fmt::format("ground truth   {}\n", describe_truth(scene));
  text += fmt::format("points         {}\n", scene.points.positions.size());
  text += fmt::format(
      "bounds         {} to {}\n", format_vector(scene.bounds_min), format_vector(scene.bounds_max)
  );
  text += fmt::format("camera extent  {:.4f}\n", scene.spatial_scale);
  return text;
}

}  // namespace glint
