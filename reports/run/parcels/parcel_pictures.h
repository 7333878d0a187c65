// SPDX-License-Identifier: MIT
// What people get to see of a run whose renders stay where they were made: three test views as
// they are, and small pictures of their maps, a small share of a parcel.
#pragma once

#include <map>
#include <string>

#include "reports/run/bench/stages.h"

namespace glint {

inline constexpr std::size_t kPictureViews = 3;
inline constexpr std::size_t kPictureBytes = std::size_t{160} << 10;  // of all

// Name in the run's folder -> PNG file: "renders/VIEW/rgb.png" as it is, "pictures/VIEW/depth.png"
// and other maps smaller. What does not fit is left out, the least telling first.
std::map<std::string, std::string> parcel_pictures(const RunSpec& spec, const Scene& scene);

}  // namespace glint
