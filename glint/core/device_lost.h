// SPDX-License-Identifier: MIT
#pragma once

#include "glint/core/error.h"

namespace glint {

// The device failed for good: in this process nothing that needs it works any more, so that no run
// after this one is worth a try.
struct DeviceLost : Error {
  explicit DeviceLost(const std::string& message) : Error(ExitCode::kEnvironment, message) {}
};

}  // namespace glint
