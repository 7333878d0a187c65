// SPDX-License-Identifier: MIT
#include "datasets/exchange/exchange_scene.h"
#include "datasets/front3d/front3d_scene.h"
#include "datasets/glassroom/make_scene.h"
#include "datasets/glassroom/write_scene.h"
#include "glint/core/rng.h"

namespace glint {
namespace {

// A room with the exposure, names and split that make_scene() gives its views. render_seed: that of
// its SceneRecipe.
ExchangeScene exchange_of_room(
    const GlassRoomScene& room, const std::string& name, std::uint64_t render_seed, Json origin
) {
  std::vector<ExchangeView> views;
  for (std::size_t i = 0; i < room.cameras.size(); ++i)
    views.push_back(
        {view_name(static_cast<int>(i)), room.cameras[i], is_test_view(static_cast<int>(i))}
    );
  return {name, room.room.scene, views, fit_exposure(room, render_seed), std::move(origin)};
}

ExchangeScene front3d_room(const Front3dOptions& options) {
  const ChosenRoom chosen = choose_front3d_room(options);
  const FurnishedRoom furnished = furnish_front3d_room(chosen, options);
  const Json origin{
      {"dataset", "front3d"},
      {"hash", front3d_hash(options)},
      {"house", chosen.house.sha256},
      {"room", chosen.room.instanceid}};
  return exchange_of_room(
      *build_front3d_scene(furnished, chosen, options),
      front3d_name(options),
      front3d_render_seed(chosen, options),
      origin
  );
}

ExchangeScene glassroom_room(const GlassRoomOptions& options) {
  const Json origin{
      {"dataset", "glassroom"},
      {"hash", glassroom_hash(options)},
      {"options", glassroom_json(options)}};
  return exchange_of_room(
      *build_glassroom_scene(options),
      options.scene,
      options.seed + hash_name(options.scene),
      origin
  );
}

}  // namespace

GLINT_PROVIDE(front3d_for_exchange, front3d_room)
GLINT_PROVIDE(glassroom_for_exchange, glassroom_room)

}  // namespace glint
