// SPDX-License-Identifier: MIT
#include "datasets/exchange/exchange_room.h"
#include "datasets/front3d/front3d_scene.h"

namespace glint {

namespace {

ExchangeScene room_for_exchange(const Front3dOptions& options) {
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

}  // namespace

GLINT_PROVIDE(front3d_for_exchange, room_for_exchange)

}  // namespace glint
