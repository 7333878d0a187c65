// SPDX-License-Identifier: MIT
#include "datasets/glassroom/glassroom.h"

#include "datasets/glassroom/make_scene.h"
#include "glint/core/error.h"
#include "glint/core/rng.h"

namespace glint {

namespace {

// Part of every cache key: raise it whenever the same options give other files.
constexpr int kGeneratorVersion = 1;

Json spec_json(const GlassRoomOptions& options) {
  GLINT_CHECK(
      options.assets.empty(),
      kUsage,
      "assets is '{}': rooms have no furniture from glTF files any more; leave it out",
      options.assets
  );
  return glassroom_json(options);
}

std::string hash_of(const GlassRoomOptions& options) {
  const Json key{{"options", spec_json(options)}, {"version", kGeneratorVersion}};
  return fmt::format("{:016x}", hash_name(key.dump()));
}

bool make_room(const GlassRoomOptions& options, const fs::path& folder, bool again) {
  const SceneRecipe recipe{
      .name = options.scene,
      .dataset = "glassroom",
      .title = "GlassRoom",
      .hash = hash_of(options),
      .version = kGeneratorVersion,
      .options = spec_json(options),
      .shots = shots_of(options),
      .render_seed = options.seed + hash_name(options.scene),
      .build = [&] { return build_glassroom_scene(options); },
      .more = {}};
  return make_scene(recipe, folder, again);
}

}  // namespace

GLINT_PROVIDE(glassroom_hash, hash_of)
GLINT_PROVIDE(make_glassroom, make_room)

}  // namespace glint
