// SPDX-License-Identifier: MIT
// The course of a training, from its log.jsonl.
#pragma once

#include "glint/core/config.h"
#include "glint/core/files.h"

namespace glint {

// {"iteration", "seconds", "loss", "psnr", "num_surfels"}: arrays of at most `points` entries, each
// the mean over a run of neighbouring lines (time, surfels and iteration: their last). Torn lines
// are skipped; null: no log, or none that can be read. "events": {"iteration", "seconds", "text"}
// of what the log shows to begin or end: each loss term, and changes of the number of surfels.
// Opacity resets are in no log.
Json training_curve(const fs::path& log, std::size_t points = 300);

}  // namespace glint
