// SPDX-License-Identifier: MIT
// A box-shaped room with a pillar in its middle, seen from inside by posed cameras: depth and
// normals in closed form.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/scene/scene.h"

namespace glint::test {

// Views from a circle around the pillar, `step` radians apart, inside the room [0,4] x [0,3] x
// [0,2.5] metres, z up. rgb, the true depth and normal and the normal prior are filled.
std::vector<View> box_room_views(int count, ImageSize size, double step = 0.15);

// The views as an EasyVolcap folder with gt/, diffrens/normal, diffrens/depth and a point cloud.
void write_easyvolcap(const fs::path& folder, const std::vector<View>& views);

// Only images and transforms.json.
void write_nerfstudio(const fs::path& folder, const std::vector<View>& views);

// Text of intri.yml and extri.yml.
std::string intri_yml(const std::vector<View>& views);
std::string extri_yml(const std::vector<View>& views);

}  // namespace glint::test
