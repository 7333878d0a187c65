// SPDX-License-Identifier: MIT
// What `doctor` says of the GPU, and `doctor --card` tells whoever lets cells share it
// (reports/run/executors/card_share.h).
#pragma once

#include <string>
#include <vector>

#include "glint/core/config.h"
#include "reports/run/provenance/checked.h"

namespace glint {

// Takes the device (choose_device()), so that what is free is what a run would find; that there is
// none is bad where it has to be: --device cuda, GLINT_REQUIRE_GPU. Errors (kUsage): `device` is
// none of --device.
std::vector<Checked> examine_card(const std::string& device);

// After it: "usable", "why_not", "name", "free_bytes" (0: on the CPU).
Json card_json();

}  // namespace glint
