// SPDX-License-Identifier: MIT
#include "datasets/exchange/exchange_room.h"

#include "datasets/glassroom/make_scene.h"
#include "datasets/glassroom/write_scene.h"

namespace glint {

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

}  // namespace glint
