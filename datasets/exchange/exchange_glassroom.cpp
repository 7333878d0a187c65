// SPDX-License-Identifier: MIT
#include "datasets/exchange/exchange_room.h"
#include "glint/core/rng.h"

namespace glint {

namespace {

ExchangeScene room_for_exchange(const GlassRoomOptions& options) {
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

GLINT_PROVIDE(glassroom_for_exchange, room_for_exchange)

}  // namespace glint
