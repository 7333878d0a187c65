// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "datasets/exchange/exchange_scene.h"
#include "datasets/glassroom/glassroom_scene.h"

namespace glint {

// A room with the exposure, names and split that make_scene() gives its views. render_seed: that of
// its SceneRecipe.
ExchangeScene exchange_of_room(
    const GlassRoomScene& room, const std::string& name, std::uint64_t render_seed, Json origin
);

}  // namespace glint
