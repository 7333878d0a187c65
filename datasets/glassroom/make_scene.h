// SPDX-License-Identifier: MIT
// From a room's description to a folder of data: the one way that every generator of rooms goes.
// Layout, views, priors, points, meshes, contact sheet and scene.json.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "datasets/glassroom/glassroom_scene.h"
#include "glint/core/config.h"
#include "glint/core/files.h"

namespace glint {

// Of a made scene: every 8th from the first on.
bool is_test_view(int view);

struct SceneRecipe {
  std::string name;     // of the scene
  std::string dataset;  // "glassroom": field of scene.json by which a folder is known again
  std::string title;    // "GlassRoom", in messages
  std::string hash;     // the cache key
  int version = 1;      // of the generator
  Json options;         // as scene.json has them
  ShotOptions shots;
  std::uint64_t render_seed = 0;
  std::function<std::unique_ptr<GlassRoomScene>()> build;
  std::function<Json(const GlassRoomScene&)>
      more;  // fields of scene.json beyond the usual; or none
};

// Makes the scene in `folder` unless it is there already with the same hash (then returns false;
// with `again` it is made all the same). Rendered into a temporary folder and renamed, so an
// interrupted run leaves no half scene. Errors (kUsage): the folder holds something else; those of
// `build`.
bool make_scene(const SceneRecipe& recipe, const fs::path& folder, bool again);

Json vector_json(Vec3f v);
Json pose_json(const Pose& pose);

}  // namespace glint
