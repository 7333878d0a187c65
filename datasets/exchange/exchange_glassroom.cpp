// SPDX-License-Identifier: MIT
#include "datasets/exchange/exchange_scene.h"
#include "datasets/glassroom/glassroom_scene.h"
#include "datasets/glassroom/make_scene.h"
#include "datasets/glassroom/write_scene.h"
#include "glint/core/rng.h"

namespace glint {

namespace {

// Seeds, exposure and split as make_glassroom() has them.
ExchangeScene room_for_exchange(const GlassRoomOptions& options) {
  const std::unique_ptr<GlassRoomScene> room = build_glassroom_scene(options);
  const float exposure = fit_exposure(*room, options.seed + hash_name(options.scene));
  std::vector<ExchangeView> views;
  for (std::size_t i = 0; i < room->cameras.size(); ++i)
    views.push_back(
        {view_name(static_cast<int>(i)), room->cameras[i], is_test_view(static_cast<int>(i))}
    );
  const Json origin{
      {"dataset", "glassroom"},
      {"hash", glassroom_hash(options)},
      {"options", glassroom_json(options)}};
  return {options.scene, room->room.scene, views, exposure, origin};
}

}  // namespace

GLINT_PROVIDE(glassroom_for_exchange, room_for_exchange)

}  // namespace glint
