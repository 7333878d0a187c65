// SPDX-License-Identifier: MIT
// Where a run happens: machine, build, device.
#pragma once

#include <string>

#include "glint/core/config.h"

namespace glint {

// Machine, threads, build (compiler, flags, libraries, git revision), weights, device and date:
// part of every record (docs/reference/records.md).
Json environment_json();

// Errors (kUsage): none of "auto", "cpu" and "cuda".
void check_device_name(const std::string& requested);

// Where ops run from now on: "cpu", "cuda", or "auto": the GPU where one is usable, else the CPU,
// with one line that says why if `say_why`. Call before the first scene is loaded. Errors:
// kEnvironment ("cuda" without a usable device), kUsage (others).
void choose_device(const std::string& requested, bool say_why = true);

}  // namespace glint
