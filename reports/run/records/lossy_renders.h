// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace glint {

// In the warning of a record whose renders came as JPEG, by which tables know it.
inline constexpr std::string_view kLossyRenders = "JPEG, which is lossy";

}  // namespace glint
