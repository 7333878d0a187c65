// SPDX-License-Identifier: MIT
// Published datasets: what the manifests state, and small folders in the official layout against
// them.
#include "reports/run/records/manifest.h"

#include <catch2/catch.hpp>
#include <numeric>

#include "reports/run/records/profile.h"
#include "reports/run/records/scene_source.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("the manifests have the scenes and counts of the official release") {
  const Manifest* dl3dv = find_manifest("ref-dl3dv");
  const Manifest* front = find_manifest("3d-front-t");
  REQUIRE(dl3dv != nullptr);
  REQUIRE(front != nullptr);
  CHECK(find_manifest("dl3dv") == nullptr);
  CHECK(dl3dv->scenes.size() == 8);
  CHECK(front->scenes.size() == 5);
  const auto test_views = [](const Manifest& manifest) {
    return std::accumulate(
        manifest.scenes.begin(),
        manifest.scenes.end(),
        0,
        [](int sum, const ManifestScene& scene) { return sum + scene.test; }
    );
  };
  CHECK(test_views(*dl3dv) == 358);
  CHECK(test_views(*front) == 113);
  for (const Manifest* manifest : {dl3dv, front})
    for (const ManifestScene& scene : manifest->scenes) {
      INFO(manifest->id << " " << scene.name);
      // Every eighth view of a contiguous list is a test view.
      CHECK(
          scene.test == (scene.train + scene.test + manifest->test_every - 1) / manifest->test_every
      );
      CHECK(scene.folder.starts_with(scene.name));
      CHECK(scene.spatial_scale > 1);
    }
  CHECK(dl3dv->scenes[0].folder.size() == 64);
  CHECK(front->scenes[2].bounds_max[1] == 2.048);
}

TEST_CASE("a scene may lie under its full name or its first digits") {
  const TempFolder data;
  const Manifest& manifest = *find_manifest("ref-dl3dv");
  const ManifestScene& scene = manifest.scenes[3];
  const fs::path full = data / "ref-dl3dv" / scene.folder, cut = data / "ref-dl3dv/543b6607";
  CHECK(manifest_scene_folder(manifest, scene, data.path()) == full);
  fs::create_directories(cut);
  CHECK(manifest_scene_folder(manifest, scene, data.path()) == cut);
  const std::string missing = missing_scenes_text(manifest, data.path());
  CHECK(missing.find("7 of 8 scenes are missing (194defaa, ") != std::string::npos);
  CHECK(missing.find("543b6607,") == std::string::npos);
  fs::create_directories(full);
  CHECK(manifest_scene_folder(manifest, scene, data.path()) == full);
}

TEST_CASE("the profile paper has the rooms and the scenes of both datasets") {
  const auto sources = load_profile("paper").sources();
  REQUIRE(sources.size() == 18);
  CHECK(sources[0].made());
  CHECK(sources[5].dataset == "3d-front-t");
  CHECK(sources[5].scene == "scene_1");
  CHECK(sources[10].dataset == "ref-dl3dv");
  CHECK(sources[10].image_ratio == 0.5);
  CHECK_FALSE(sources[10].made());
  const TempFolder data;
  const SceneIdentity identity = identify_source(sources[10], data.path());
  CHECK(identity.why_not.find("194defaa") != std::string::npos);
}
